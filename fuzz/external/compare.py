#!/usr/bin/env python3
"""Compares somebody's decoder with frames whose correct decoding is known.

Usage: compare.py [--rubric FILE] [--count N] [--seed S] [--valid 0.7] [--spec rubicon]
                  [--carrier NAME ...] -- COMMAND...

COMMAND is started once. For each frame it reads a line and writes a line, see README.md. Exit
codes: 0 it agrees with all, 1 it does not, 2 it could not be run.
"""

import argparse
import collections
import json
import os
import queue
import subprocess
import sys
import threading

SHOWN = 20
PATIENCE_S = 30


def expectations(options):
    """The frames, as `rubric generate` writes them."""
    command = [options.rubric, "generate", "--fields", "--count", str(options.count), "--seed",
               str(options.seed), "--valid", str(options.valid), "--spec", options.spec]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"compare.py: {done.stderr.decode().strip()}")
    frames = [json.loads(line) for line in done.stdout.splitlines()]
    return [frame for frame in frames if not options.carrier or frame["carrier"] in options.carrier]


def wanted(frame):
    """Returns the expected result in words."""
    if frame["error"] is None:
        return f"accepted as {'/'.join(frame['path'])}"
    error = frame["error"]
    return f"refused, {error['fault']} at byte {error['offset']} by {error['requirement']}"


def wrong_field(frame, given):
    """The first field that the decoder read otherwise, in words; None if there is none."""
    values = collections.defaultdict(list)
    for field in frame["fields"]:
        values[field["field"]].append(field["value"])
    for name, value in given.items():
        if name not in values:
            return f"{name} is {value}, but no such field is there"
        expected = values[name] if len(values[name]) > 1 else values[name][0]
        if value not in (expected, values[name]):
            return f"{name} should have been {expected}, was {value}"
    return None


def disagreement(frame, answer):
    """Returns what is wrong with the answer, in words; None if nothing is."""
    accepts = answer.get("accept")
    if not isinstance(accepts, bool):
        return f"should have been {wanted(frame)}, but the answer was {json.dumps(answer)}"
    if accepts != (frame["verdict"] == "valid"):
        why = f": {answer['why']}" if answer.get("why") else ""
        return f"should have been {wanted(frame)}, was {'accepted' if accepts else 'refused'}{why}"
    return wrong_field(frame, answer.get("fields", {})) if accepts else None


def describe(frame, problem):
    """A report of one frame; for decoders of other inputs, too."""
    lines = [f"frame {frame['number']}, {frame['message']} on {frame['carrier']}: {problem}"]
    if frame["what"] != "valid":
        lines.append(f"  what is wrong with it: {frame['what']}")
    if frame["error"]:
        lines.append(f"  the rule: rubric explain {frame['error']['requirement']}")
    lines.append(f"  {frame['raw']}")
    return "\n".join(lines)


class Tally:
    """Counts answers, and reports the first disagreements."""

    def __init__(self):
        self.agreed = collections.Counter()
        self.fields = 0
        self.skipped = 0
        self.disagreements = 0

    def take(self, frame, answer):
        """Judges one answer."""
        if answer.get("skip") is True:
            self.skipped += 1
            return
        problem = disagreement(frame, answer)
        if problem is None:
            self.agreed[frame["verdict"]] += 1
            self.fields += len(answer.get("fields", {}))
        else:
            self.report(frame, problem)

    def report(self, frame, problem):
        """Counts a disagreement, and shows it if it is among the first."""
        self.disagreements += 1
        if self.disagreements <= SHOWN:
            print(describe(frame, problem))

    def exit_code(self, count):
        """Says what came of it."""
        print(f"{count} frames: {self.agreed['valid']} accepted and {self.agreed['malformed']} "
              f"refused as expected, {self.fields} fields as expected, {self.skipped} skipped, "
              f"{self.disagreements} disagreements")
        if not self.agreed["valid"] or not self.agreed["malformed"]:
            print("Too little was compared to say anything.")
            return 1
        return 1 if self.disagreements else 0


class Decoder:
    """The program under test, in a process of its own."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, encoding="utf-8", errors="replace")
        self.answers = queue.Queue()

    def _write(self, frames):
        try:
            for frame in frames:
                self.process.stdin.write(f"{frame['carrier']} {frame['raw']}\n")
            self.process.stdin.close()
        except BrokenPipeError:
            pass  # It ended early; the missing answers show it.

    def _read(self):
        for line in self.process.stdout:
            self.answers.put(line)
        self.answers.put(None)

    def run(self, frames):
        """Yields (frame, answer); an answer of None: none came, and none will."""
        for work in (lambda: self._write(frames), self._read):
            threading.Thread(target=work, daemon=True).start()
        for frame in frames:
            try:
                line = self.answers.get(timeout=PATIENCE_S)
            except queue.Empty:
                line = None
            yield frame, line
            if line is None:
                self.process.kill()
                return
        self.process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    built = "build/release/rubric"
    parser.add_argument("--rubric", default=built if os.path.exists(built) else "rubric")
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--valid", type=float, default=0.7)
    parser.add_argument("--spec", default="rubicon")
    parser.add_argument("--carrier", nargs="+", help="only frames of these")
    parser.add_argument("command", nargs="+", metavar="COMMAND")
    options = parser.parse_args()
    frames = expectations(options)
    try:
        decoder = Decoder(options.command)
    except OSError as error:
        print(f"compare.py: {options.command[0]}: {error.strerror}", file=sys.stderr)
        return 2
    tally = Tally()
    for frame, line in decoder.run(frames):
        if line is None:
            tally.report(frame, f"no answer came; should have been {wanted(frame)}")
            break
        try:
            answer = json.loads(line)
        except ValueError:
            answer = None
        if isinstance(answer, dict):
            tally.take(frame, answer)
        else:
            tally.report(frame, f"the answer is not a JSON object: {line.strip()[:80]}")
    return tally.exit_code(len(frames))


if __name__ == "__main__":
    sys.exit(main())
