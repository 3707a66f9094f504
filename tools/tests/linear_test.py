#!/usr/bin/env python3
"""Output and work of commands grow no faster than their input, on shapes that provoke that.

Compares runs on 1, 10 and 100 parts of the same shape by bytes written and by CPU time. What grows
with the square takes 100 times for each step of 10, so the bounds are far from both.
Usage: linear_test.py RUBRIC
"""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

RUBRIC = sys.argv[1]
PARTS = 60
STEP = 10
BYTES_MOST = 1.5 * STEP
CPU_MOST = 4 * STEP
CPU_FLOOR_S = 0.1  # Less is start and noise.


def block(kind, body):
    body += bytes(-len(body) % 4)
    size = len(body) + 12
    return struct.pack("<II", kind, size) + body + struct.pack("<I", size)


def capture(frames, apart_us=1000):
    out = block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))
    out += block(1, struct.pack("<HHI", 230, 0, 0))
    for i, frame in enumerate(frames):
        time = i * apart_us
        head = struct.pack("<IIIII", 0, time >> 32, time & 0xFFFFFFFF, len(frame), len(frame))
        out += block(6, head + frame)
    return out


def radio(number, dest, src, kind, payload):
    return struct.pack("<HBHHHBB", 0x8841, number & 255, 0x22, dest, src, 0x3F, kind) + payload


def request(number):
    return struct.pack(">HBHB", number & 0xFFFF, 1, 0x43, 1)


SHAPES = {
    "many senders that break a rule":
        lambda n: capture(radio(i, 0xFFFF, 1000 + i, 14, request(i)) for i in range(n)),
    "many senders of half a message":
        lambda n: capture(radio(i, 1, 1000 + i, 14, request(i)[:3]) for i in range(n)),
    "one sender that repeats itself":
        lambda n: capture(radio(i, 0xFFFF, 2, 14, request(i)) for i in range(n)),
    "everybody to everybody":
        lambda n: capture(radio(i, 1000 + i * 7 % n, 1000 + i, 14, request(7)) for i in range(n)),
    "all at once":
        lambda n: capture((radio(i, 1, 1000 + i, 14, request(i)) for i in range(n)), 0),
    "types that nobody knows":
        lambda n: capture(radio(i, 1, 2, i & 255, b"\xff" * 90) for i in range(n)),
}
COMMANDS = (("check",), ("check", "--verbose"), ("check", "--format", "json"),
            ("check", "--format", "junit"), ("decode",), ("decode", "--format", "jsonl"),
            ("stats",), ("convert", "--format", "hex"))


def measure(command, path):
    """Returns the bytes that it writes and the CPU seconds that it takes."""
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen([RUBRIC, *command, path], stdout=out, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        assert child.returncode in (0, 1, 3), (command, child.returncode)
        return out.seek(0, os.SEEK_END), usage.ru_utime + usage.ru_stime


class Linear(unittest.TestCase):
    def test_commands(self):
        with tempfile.TemporaryDirectory(prefix="rubric-linear-") as folder:
            path = pathlib.Path(folder) / "x.pcapng"
            for name, shape in SHAPES.items():
                inputs = [shape(PARTS * STEP ** power) for power in range(3)]
                for command in COMMANDS:
                    before = None
                    for data in inputs:
                        path.write_bytes(data)
                        size, cpu = measure(command, path)
                        if before:
                            self.assertLessEqual(size, BYTES_MOST * before[0] + 2000,
                                                 (name, command))
                            self.assertLessEqual(cpu, CPU_MOST * max(before[1], CPU_FLOOR_S),
                                                 (name, command))
                        before = size, cpu


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
