#!/usr/bin/env python3
"""Many runs with one command: in order, in parts, and never twice.

Usage: each_test.py RUBRIC
"""
import ctypes
import gzip
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import time
import unittest

import testing
from testing import FIRMWARE, RUBRIC

CAPTURES = sorted(FIRMWARE.glob("*.pcapng"))
PATIENCE_S = 60
FAILED, INCONCLUSIVE, BROKEN, USAGE, UNREADABLE, OUTPUT = 1, 3, 2, 64, 66, 74


def run(*words, **how):
    return testing.run(*words, text=True, timeout=PATIENCE_S, **how)


def lines(text):
    return [json.loads(line) for line in text.splitlines()]


def as_others():
    """Takes the right to read everything from root, where that is possible."""
    for right in (1, 2):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
        ctypes.CDLL(None).prctl(24, right, 0, 0, 0)  # PR_CAPBSET_DROP


def may_look(folder):
    return subprocess.run(["ls", folder], preexec_fn=as_others, check=False,
                          capture_output=True).returncode == 0


class Each(testing.Folder):
    def setUp(self):
        super().setUp()
        self.runs = self.folder / "runs"
        (self.runs / "deep").mkdir(parents=True)
        for i, capture in enumerate(CAPTURES):
            shutil.copy(capture, self.runs / ("deep" if i % 3 == 0 else ".") / capture.name)
        (self.runs / "notes.txt").write_text("no capture")

    def test_each_is_as_alone(self):
        for jobs in (1, 2, 5):
            done = run("check", "--each", self.runs, "--jobs", jobs)
            found = lines(done.stdout)
            names = [line["file"] for line in found]
            self.assertEqual(names, sorted(str(p) for p in self.runs.rglob("*.pcapng")))
            self.assertEqual(done.returncode, FAILED)
            self.assertIn(f"{len(CAPTURES)} runs", done.stderr)
        for line in found:
            alone = run("check", line["file"], "--format", "json")
            report = json.loads(alone.stdout)
            self.assertEqual(line["schema"], "rubric.each/1")
            self.assertEqual(line["exit_code"], alone.returncode)
            self.assertEqual(line["verdict"], report["verdict"])
            self.assertEqual(line["frames"], report["counts"]["frames"])
            fails = [f for f in report["findings"] if f["severity"] == "fail"]
            self.assertEqual(sum(f["findings"] for f in line["failures"]), len(fails))
            self.assertEqual({f["requirement"] for f in line["failures"]},
                             {f["requirement"] for f in fails})
            self.assertGreaterEqual(line["begin"], 0)

    def test_the_gravest_decides(self):
        good = run("check", "--each", CAPTURES[0], "--profile", "deployed")
        self.assertEqual(good.returncode, run("check", CAPTURES[0], "--profile",
                                              "deployed").returncode)
        (self.runs / "broken.pcapng").write_bytes(b"nothing")
        done = run("check", "--each", self.runs, self.folder / "gone.pcapng")
        self.assertEqual(done.returncode, UNREADABLE)
        found = {pathlib.Path(line["file"]).name: line for line in lines(done.stdout)}
        for name in ("broken.pcapng", "gone.pcapng"):
            self.assertEqual(found[name]["exit_code"], UNREADABLE)
            self.assertIn(name, found[name]["error"])
        self.assertEqual(len(found), len(CAPTURES) + 2)

    def test_what_cannot_be_looked_at_is_a_run_too(self):
        (self.runs / "loop.pcapng").symlink_to("loop.pcapng")
        (self.runs / "nowhere.pcapng").symlink_to("nothing")
        (self.runs / "up").symlink_to("..")
        closed = self.runs / "closed"
        closed.mkdir(0)
        self.addCleanup(closed.chmod, 0o700)
        for words in (("check",), ("decode", "--jobs", "2")):
            done = run(words[0], "--each", self.runs, *words[1:], preexec_fn=as_others)
            self.assertEqual(done.returncode, UNREADABLE, done.stderr)
            found = {pathlib.Path(line["file"]).name: line for line in lines(done.stdout)}
            self.assertEqual(set(found) - {"closed"},
                             {capture.name for capture in CAPTURES} |
                             {"loop.pcapng", "nowhere.pcapng"})
            for name in set(found) - {capture.name for capture in CAPTURES}:
                self.assertEqual(found[name]["exit_code"], UNREADABLE)
                self.assertIn(name, found[name]["error"])
            if may_look(closed):
                continue
            self.assertIn("closed", found)
            for k in range(3):  # It may hold files of each shard.
                part = run(words[0], "--each", self.runs, "--shard", f"{k + 1}/3",
                           preexec_fn=as_others)
                self.assertIn(str(closed), [line["file"] for line in lines(part.stdout)])
        done = run("check", "--each", self.runs / "*.pcapng")
        self.assertEqual(done.returncode, UNREADABLE, done.stderr)

    def test_names_that_mean_something_elsewhere(self):
        odd = self.folder / "odd"
        odd.mkdir()
        names = ["a\nb.pcapng", "-x.pcapng", "--out=z.pcapng", "*.pcapng", "[a].pcapng", " .pcapng",
                 'q"\\{}.pcapng', 'exit_code":7.pcapng']
        for name in names:
            shutil.copy(CAPTURES[0], odd / name)
        done = run("check", "--each", odd, "--resume", self.folder / "state")
        self.assertEqual([line["file"] for line in lines(done.stdout)],
                         sorted(str(odd / name) for name in names))
        again = run("check", "--each", odd, "--resume", self.folder / "state")
        self.assertEqual(again.stdout, done.stdout)
        self.assertIn(f"({len(names)} known", again.stderr)

    def test_patterns(self):
        done = run("check", "--each", self.runs / "*_join*.pcapng", self.runs / "deep")
        wanted = set(self.runs.glob("*_join*.pcapng")) | set((self.runs / "deep").iterdir())
        self.assertEqual([line["file"] for line in lines(done.stdout)],
                         sorted(map(str, wanted)))
        none = run("check", "--each", self.runs / "none*")
        self.assertEqual(none.returncode, USAGE)
        self.assertIn("holds no runs", none.stderr)

    def test_compressed_runs_of_a_folder(self):
        packed = self.folder / "packed"
        packed.mkdir()
        (packed / "run.pcapng.gz").write_bytes(gzip.compress(CAPTURES[0].read_bytes()))
        (packed / "notes.txt.gz").write_bytes(gzip.compress(b"no capture"))
        plain, = lines(run("check", "--each", CAPTURES[0]).stdout)
        found, = lines(run("check", "--each", packed).stdout)
        self.assertEqual((found["frames"], found["failures"]), (plain["frames"], plain["failures"]))

    def test_shards(self):
        for shards in (1, 2, 3, 7):
            parts = [[line["file"] for line in lines(
                run("check", "--each", self.runs, "--shard", f"{k + 1}/{shards}").stdout)]
                for k in range(shards)]
            self.assertEqual(sorted(sum(parts, [])),
                             sorted(str(p) for p in self.runs.rglob("*.pcapng")))
        self.assertGreater(sum(1 for part in parts if part), 1)
        moved = self.folder / "moved"
        shutil.copytree(self.runs, moved)
        (moved / "a_new_one.pcapng").write_bytes(CAPTURES[0].read_bytes())
        for k, part in enumerate(parts):
            again = [line["file"].replace(str(moved), str(self.runs)) for line in lines(
                run("check", "--each", moved, "--shard", f"{k + 1}/{shards}").stdout)
                if "a_new_one" not in line["file"]]
            self.assertEqual(again, part)
        for k in range(2):  # Where one machine lacks the folder, nothing of its part was judged.
            self.assertEqual(run("check", "--each", self.folder / "absent", "--shard",
                                 f"{k + 1}/2").returncode, UNREADABLE)
        for text in ("0/2", "3/2", "1", "1/0", "a/b", "1/2x", "/"):
            self.assertEqual(run("check", "--each", self.runs, "--shard", text).returncode, USAGE)

    def test_resume(self):
        state = self.folder / "state"
        first = run("check", "--each", self.runs, "--resume", state)
        kept = state.read_bytes()
        again = run("check", "--each", self.runs, "--resume", state)
        self.assertEqual(again.stdout, first.stdout)
        self.assertEqual(again.returncode, first.returncode)
        self.assertIn(f"({len(CAPTURES)} known by --resume)", again.stderr)
        self.assertEqual(state.read_bytes(), kept)
        other = run("check", "--each", self.runs, "--resume", state, "--profile", "deployed")
        self.assertNotIn("known", other.stderr)
        touched = next(self.runs.glob("*.pcapng"))
        os.utime(touched, (1, 1))
        self.assertIn(f"({len(CAPTURES) - 1} known",
                      run("check", "--each", self.runs, "--resume", state).stderr)
        # Of what a kill cut short, only that line is done again.
        cut = kept.split(b"\n")
        state.write_bytes(b"\n".join(cut[:-2]) + b"\n" + cut[-2][:40])
        os.utime(touched)
        again = run("check", "--each", self.runs, "--resume", state)
        self.assertEqual([line["file"] for line in lines(again.stdout)],
                         [line["file"] for line in lines(first.stdout)])
        third = run("check", "--each", self.runs, "--resume", state)
        self.assertIn(f"({len(CAPTURES)} known", third.stderr)
        # The text of a spec counts, too.
        spec = self.folder / "mine.ksy"
        text = pathlib.Path("spec/wire/oscilloscope.ksy").read_text(encoding="utf-8")
        how = ("decode", "--each", touched, "--spec", spec, "--resume", self.folder / "decoded")
        for says, known in ((text, False), (text, True), (text + "# other\n", False)):
            spec.write_text(says, encoding="utf-8")
            self.assertEqual("(1 known" in run(*how).stderr, known)
        # A line of another version counts for nothing, and a device is no state.
        other = kept.splitlines()[0].replace(b"rubric.each/1", b"rubric.each/0")
        state.write_bytes(kept.splitlines()[-1] + b"\n" + other + b"\n")
        again = run("check", "--each", self.runs, "--resume", state)
        self.assertEqual(again.stdout, first.stdout)
        self.assertNotIn(f"({len(CAPTURES)} known", again.stderr)
        for path, code in (("/dev/full", USAGE), (self.folder, OUTPUT),
                           (self.folder / "no" / "state", OUTPUT)):
            done = run("check", "--each", self.runs, "--resume", path)
            self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        state.write_bytes(b"something of mine\n")
        self.assertEqual(run("check", "--each", self.runs, "--resume", state).returncode, USAGE)
        self.assertEqual(state.read_bytes(), b"something of mine\n")
        self.assertEqual(run("check", "--each", touched, "--resume", touched).returncode, USAGE)

    def test_what_is_read_otherwise_is_not_known(self):
        state = self.folder / "state"
        words = ("decode", "--each", self.runs, "--resume", state)
        run(*words)
        self.assertIn(f"({len(CAPTURES)} known", run(*words).stderr)
        self.assertNotIn("known", run(*words, "--link-type", "150=radio-fcs").stderr)

    def test_a_run_that_is_killed_is_broken(self):
        for command in ("check", "decode"):
            waits = self.folder / f"{command}.pcapng"
            os.mkfifo(waits)
            process = subprocess.Popen([RUBRIC, command, "--each", str(waits)], text=True,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.addCleanup(process.kill)
            children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
            for _ in range(6000):
                found = children.read_text(encoding="ascii").split()
                if found:
                    break
                time.sleep(0.01)
            os.kill(int(found[0]), signal.SIGKILL)
            out, _ = process.communicate(timeout=60)
            line, = lines(out)
            self.assertEqual((process.returncode, line["exit_code"]), (BROKEN, BROKEN))
            self.assertIn("was killed by signal 9", line["error"])

    def test_killed_at_any_point(self):
        state = self.folder / "state"
        whole = run("check", "--each", self.runs).stdout
        for delay in (0.02, 0.05, 0.1, 0.15):
            child = subprocess.Popen([RUBRIC, "check", "--each", str(self.runs), "--resume",
                                      str(state), "--jobs", "2"], stdout=subprocess.DEVNULL,
                                     stderr=subprocess.DEVNULL, start_new_session=True)
            time.sleep(delay)
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
        done = run("check", "--each", self.runs, "--resume", state)
        self.assertEqual(done.stdout, whole)

    def test_a_run_that_kills_its_process(self):
        limit = ("ulimit -v 400000; exec \"$0\" \"$@\"",)
        huge = self.runs / "huge.rtr"
        huge.write_bytes(b"%rtr 1\n" + b"x" * 200_000_000)
        done = subprocess.run(["sh", "-c", *limit, RUBRIC, "check", "--each", str(self.runs),
                               "--jobs", "2"], capture_output=True, check=False, text=True,
                              timeout=PATIENCE_S)
        found = {pathlib.Path(line["file"]).name: line for line in lines(done.stdout)}
        self.assertEqual(len(found), len(CAPTURES) + 1)
        self.assertNotIn(found["huge.rtr"]["exit_code"], (0,))
        self.assertEqual(sum(line["exit_code"] in (0, 1, 3) for line in found.values()),
                         len(CAPTURES))

    def test_decode(self):
        done = run("decode", "--each", self.runs, "--jobs", "2")
        for line in lines(done.stdout):
            shown = run("decode", line["file"], "--format", "jsonl")
            self.assertEqual(line["exit_code"], shown.returncode)
            self.assertEqual(line["frames"], len(shown.stdout.splitlines()))
        self.assertEqual(done.returncode, max(line["exit_code"] for line in lines(done.stdout)))
        filtered = lines(run("decode", "--each", self.runs, "--filter", "message==updates").stdout)
        self.assertGreater(sum(line["shown"] for line in filtered), 0)
        wrong = run("decode", "--each", self.runs, "--filter", "message==nothing")
        self.assertEqual((wrong.returncode, wrong.stdout), (USAGE, ""))

    def test_specs_are_read_once(self):
        """A run that fits none looks at all; what they take to read is spent for one run."""
        strange = self.folder / "strange"
        strange.mkdir()
        (strange / "0.hex").write_text("00ffff000501000e00\n")
        for words in (("check",), ("decode", "--jobs", "2")):
            alone = self.cpu_seconds(*words, "--each", strange / "0.hex")
            for i in range(1, 30):
                shutil.copy(strange / "0.hex", strange / f"{i}.hex")
            self.assertLess(self.cpu_seconds(*words, "--each", strange), 10 * alone)

    def cpu_seconds(self, *words):
        """The least of some attempts."""
        taken = []
        for _ in range(3):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            run(*words)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        return min(taken)

    def test_output_that_breaks(self):
        self.assertEqual(run("check", "--each", self.runs, "--out", "/dev/full").returncode, OUTPUT)
        out = self.folder / "out.jsonl"
        done = run("check", "--each", self.runs, "--out", out)
        self.assertEqual(len(lines(out.read_text())), len(CAPTURES))
        self.assertEqual(done.stdout, "")
        self.assertEqual(testing.run_unread("check", "--each", self.runs).returncode, OUTPUT)

    def test_what_makes_no_sense(self):
        for words in (("--jobs", "2"), ("--resume", "x"), ("--shard", "1/2"),
                      ("--each", "--follow"), ("--each", "--frames", "1..2"),
                      ("--each", "--jobs", "0")):
            self.assertEqual(run("check", CAPTURES[0], *words).returncode, USAGE, words)
        for words in (("--report", self.folder / "report"), ("--format", "junit")):
            done = run("check", "--each", self.runs, *words)
            self.assertEqual((done.returncode, done.stdout), (USAGE, ""), words)


if __name__ == "__main__":
    unittest.main()
