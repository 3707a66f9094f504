#!/usr/bin/env python3
"""`rubric decode` in several threads prints what it prints in one.

Usage: decode_threads_test.py RUBRIC
"""
import hashlib
import pathlib
import random
import shutil
import tempfile
import unittest

import testing
from testing import FIRMWARE

LONG_BYTES = 64 << 20  # From here on all cores decode by themselves.
PATIENCE_S = 300
UNREADABLE, OUTPUT = 66, 74


def run(*words):
    done = testing.run("decode", *words)
    return done.returncode, hashlib.sha256(done.stdout).hexdigest(), len(done.stdout), done.stderr


class Threads(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubric-threads-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        line = b"".join(path.read_bytes() for path in sorted(FIRMWARE.glob("*.serial.bin")))
        cls.line = cls.folder / "line.bin"
        cls.line.write_bytes(line * 8)
        damaged = bytearray(line * 8)
        rng = random.Random(1)
        for _ in range(len(damaged) // 100):
            damaged[rng.randrange(len(damaged))] = rng.choice([0x7e, 0x7d, rng.randrange(256)])
        cls.damaged = cls.folder / "damaged.bin"
        cls.damaged.write_bytes(damaged)
        cls.long = cls.folder / "long.bin"
        cls.long.write_bytes(line * (LONG_BYTES // len(line) + 1))

    def assert_same(self, *words):
        alone = run(*words, "--jobs", 1)
        for jobs in (2, 5):
            self.assertEqual(run(*words, "--jobs", jobs), alone, (jobs, words))
        self.assertGreater(alone[2], 0)
        return alone

    def test_all_forms(self):
        for form in (("--format", "text"), ("--format", "jsonl"), ("--format", "csv"), ("--hex",),
                     ("--filter", "message==updates"), ("--fields", "index,time,message"),
                     ("--time", "utc"), ("--units",), ("--strict",)):
            self.assert_same(self.line, *form)
            self.assertEqual(self.assert_same(self.damaged, *form)[0], 1)

    def test_lines_that_depend_on_each_other(self):
        captures = sorted(FIRMWARE.glob("*.pcapng"))
        for form in (("--time", "relative"), ("--time", "delta"), ("--count", "70")):
            self.assert_same(*captures, *form)

    def test_many_files(self):
        captures = sorted(FIRMWARE.glob("*.pcapng")) + sorted(FIRMWARE.glob("*.serial.bin"))
        self.assert_same(*captures, *captures, "--format", "jsonl")
        found = self.assert_same(*captures, self.folder / "gone.bin", *captures)
        self.assertEqual(found[0], UNREADABLE)

    def test_a_long_capture(self):
        alone = run(self.long, "--format", "jsonl", "--jobs", 1)
        self.assertEqual(run(self.long, "--format", "jsonl"), alone)

    def test_nobody_reads(self):
        for jobs in (1, 3):
            done = testing.run_unread("decode", self.line, "--jobs", jobs)
            self.assertEqual((done.returncode, done.stderr), (OUTPUT, b""))


if __name__ == "__main__":
    unittest.main()
