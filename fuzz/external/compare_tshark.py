#!/usr/bin/env python3
"""Compares Wireshark's dissector with frames whose correct decoding is known.

Usage: compare_tshark.py [--rubric FILE] [--dissector FILE.lua] [--count N] [--seed S]

Packets that the dissector leaves to others, such as radio frames of another PAN, are skipped. Of
those that it takes each field counts, in order, and of the malformed ones the fault, its place and
its rule. Exit codes as those of compare.py.
"""

import argparse
import collections
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import compare  # noqa: E402: only now, lest it leave its bytecode beside it

DISSECTOR = "tools/wireshark/generated/rubric.lua"
# Fields that the dissector adds, and those around a packet on its line.
ADDED = {"rubric.am_type", "rubric.path", "rubric.message", "rubric.fault", "rubric.fault_offset",
         "rubric.rule", "rubric.stale", "rubric.serial.kind", "rubric.serial.seq_num",
         "rubric.serial.crc"}


def generated(options, folder):
    """The capture, and the expectation of each of its packets."""
    capture, beside = folder / "frames.pcapng", folder / "frames.jsonl"
    subprocess.run([options.rubric, "generate", "--format", "pcapng", "--fields", "-o",
                    str(capture), "--expect", str(beside), "--count", str(options.count), "--seed",
                    str(options.seed)], check=True)
    return capture, [json.loads(line) for line in beside.read_text("utf-8").splitlines()]


def dissected(capture, dissector):
    """The layers of each packet, as pairs of name and value: names repeat."""
    done = subprocess.run(["tshark", "-r", str(capture), "-X", f"lua_script:{dissector}", "-T",
                           "json"], capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"compare_tshark.py: tshark: {done.stderr.decode().strip()}")
    packets = json.loads(done.stdout, object_pairs_hook=list)
    return [dict(dict(packet)["_source"])["layers"] for packet in packets]


def whole_numbers(pairs):
    """(name, value) of the fields of an opened tree, in their order, but for bits of masks."""
    for name, value in pairs:
        if isinstance(value, list):
            if not name.endswith("_tree"):
                yield from whole_numbers(value)
        elif name.startswith("rubric.") and name not in ADDED:
            try:
                yield last(name), int(value, 0)
            except ValueError:
                pass  # A float, or bytes.


def answer(layers):
    """As a decoder for compare.py would answer; fields as a list."""
    names = dict(layers)
    layer = names.get("rubric")
    if layer is None:
        return {"skip": True}
    for name in names:
        if name.startswith(("Lua Error", "_ws.malformed")):  # It read beyond the frame's end.
            return {"crash": name}
    said = dict(layer)
    if "rubric.fault" in said:
        error = {"fault": said["rubric.fault"], "offset": int(said["rubric.fault_offset"]),
                 "requirement": said.get("rubric.rule")}
        return {"accept": False, "error": error, "why": "{fault} at byte {offset} by {requirement}"
                .format(**error)}
    return {"accept": True, "list": list(whole_numbers(layer))}


def last(name):
    return name.rsplit(".", 1)[1]


def scalars(frames):
    """For each way of messages the names in expectations, which have no arrays and no floats."""
    names = collections.defaultdict(set)
    for frame in frames:
        if not frame["error"]:
            names[tuple(frame["path"])].update(last(one["field"]) for one in frame["fields"])
    return names


def closer(frame, given, names):
    """Returns what is wrong with an answer whose verdict is right; None if nothing is."""
    if frame["error"]:
        if given["error"] != frame["error"]:
            return f"should have been {compare.wanted(frame)}, was refused: {given['why']}"
        return None
    expected = [(last(one["field"]), one["value"]) for one in frame["fields"]
                if not one["field"].startswith("mac_header.")]  # Wireshark's own shows it.
    given["list"] = [one for one in given["list"] if one[0] in names[tuple(frame["path"])]]
    for right, found in zip(expected, given["list"]):
        if right != found:
            return f"{right[0]} should have been {right[1]}, was {found[0]} {found[1]}"
    if len(expected) != len(given["list"]):
        return f"should have had {len(expected)} fields, had {len(given['list'])}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rubric", default="build/release/rubric")
    parser.add_argument("--dissector", default=DISSECTOR)
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="compare-tshark-") as folder:
        capture, frames = generated(options, pathlib.Path(folder))
        layers = dissected(capture, options.dissector)
    tally = compare.Tally()
    names = scalars(frames)
    if len(layers) != len(frames):
        print(f"tshark shows {len(layers)} packets, expected {len(frames)}")
        return 1
    for frame, of_packet in zip(frames, layers):
        given = answer(of_packet)
        skipped = given.get("skip") is True
        problem = None if skipped else (compare.disagreement(frame, given) or
                                        closer(frame, given, names))
        if problem:
            tally.report(frame, problem)
        else:
            tally.take(frame, given)
            tally.fields += len(given.get("list", []))
    return tally.exit_code(len(frames))


if __name__ == "__main__":
    sys.exit(main())
