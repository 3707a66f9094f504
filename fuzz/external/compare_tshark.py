#!/usr/bin/env python3
"""Holds a Wireshark dissector against frames of which is known what a decoder must say.

Usage: compare_tshark.py [--rubric FILE] [--dissector FILE.lua] [--count N] [--seed S]

The dissector is of serial frames (link type USER0); it adds tinyos_am.malformed where it refuses a
frame. Packets of other link types are skipped. Exit codes as those of compare.py.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
import compare  # noqa: E402: only now, lest it leave its bytecode beside it

HERE = pathlib.Path(__file__).resolve().parent
# How the dissector's fields are called here.
FIELDS = {
    "tinyos_am.dest": "am_header.dest",
    "tinyos_am.src": "am_header.src",
    "tinyos_am.length": "am_header.length",
    "tinyos_am.group": "am_header.group",
    "tinyos_am.type": "am_header.type",
    "tinyos_am.net.reliable": "net_msg.reliable",
    "tinyos_am.net.seq_num": "net_msg.seq_num",
    "tinyos_am.net.nbytes": "net_msg.nbytes",
    "tinyos_am.code": "config.type",
    "tinyos_am.config.value": "config.value",
}


def generated(options, folder):
    """The capture, and the expectation of each of its packets."""
    capture, beside = folder / "frames.pcapng", folder / "frames.jsonl"
    subprocess.run([options.rubric, "generate", "--format", "pcapng", "--fields", "-o",
                    str(capture), "--expect", str(beside), "--count", str(options.count), "--seed",
                    str(options.seed)], check=True)
    return capture, [json.loads(line) for line in beside.read_text("utf-8").splitlines()]


def dissected(capture, dissector):
    """The layers of each packet."""
    done = subprocess.run(["tshark", "-r", str(capture), "-X", f"lua_script:{dissector}", "-T",
                           "json"], capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"compare_tshark.py: tshark: {done.stderr.decode().strip()}")
    packets = json.loads(done.stdout)
    return [packet["_source"]["layers"] for packet in packets]


def answer(layers):
    """As a decoder for compare.py would answer."""
    for name in layers:
        if name.startswith("Lua Error"):
            return {"crash": name}
    layer = layers.get("tinyos_am")
    if layer is None:
        return {"skip": True}
    if "tinyos_am.malformed" in layer:
        return {"accept": False, "why": layer["tinyos_am.malformed"]}
    fields = {FIELDS[key]: int(value, 0) for key, value in layer.items() if key in FIELDS}
    return {"accept": True, "fields": fields}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rubric", default="build/release/rubric")
    parser.add_argument("--dissector", default=str(HERE / "am_dissector.lua"))
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="compare-tshark-") as folder:
        capture, frames = generated(options, pathlib.Path(folder))
        layers = dissected(capture, options.dissector)
    tally = compare.Tally()
    if len(layers) != len(frames):
        print(f"tshark shows {len(layers)} packets, expected {len(frames)}")
        return 1
    for frame, of_packet in zip(frames, layers):
        tally.take(frame, answer(of_packet))
    return tally.exit_code(len(frames))


if __name__ == "__main__":
    sys.exit(main())
