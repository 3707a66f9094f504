"""rubric repro: from an input that breaks a flawed machine to a golden trace that finds the flaw.

Usage: repro_test.py RUBRIC MACHINE_FUZZ_REPLAY SCRIPT_SEEDS [CLASS]
"""

import os
import pathlib
import random
import re
import subprocess
import sys
import unittest

from testing import ROOT, Folder, rubric as run

REPLAY, SEEDS = sys.argv[1:3]

# Flaws of release 1.0, and the rules that they break, as `rubric explore --help` and the flaws say.
FLAWS = {
    "accepts_wrong_seq": {"J4-SEQ", "J5-ACCEPT"},
    "no_fail": {"J8-FAIL", "J5-ONCE"},
    "misread_acks": {"T3-SUCCESS"},
    "answers_members": {"J2-LISTED"},
}


def write_seeds(folder):
    subprocess.run([SEEDS, ROOT / "conformance/cases", folder], check=True, capture_output=True)
    return sorted(pathlib.Path(folder).iterdir())


def mutants(seeds, count, seed):
    """Bytes of golden traces with a few of them changed, as any fuzzer makes them."""
    chance = random.Random(seed)
    for _ in range(count):
        data = bytearray(chance.choice(seeds).read_bytes())
        for _ in range(chance.randrange(1, 4)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        yield bytes(data)


class Fuzzed(Folder):
    def setUp(self):
        super().setUp()
        self.seeds = write_seeds(self.folder / "seeds")

    def find(self, flaw):
        """The first input that makes machine_fuzz end, with this flaw in the machine's place, and
        shows what no decision leaves open, as `rubric shrink` knows."""
        inputs = self.folder / flaw
        inputs.mkdir()
        for i, data in enumerate(mutants(self.seeds, 2000, 1)):
            (inputs / f"{i:04}").write_bytes(data)
        while True:
            done = subprocess.run([REPLAY, inputs], capture_output=True, text=True, check=False,
                                  env={**os.environ, "RUBRIC_FLAW": flaw}, cwd=ROOT)
            self.assertNotEqual(done.returncode, 0, f"{flaw} was not found")
            self.assertIn("broken: ", done.stderr)
            tried = [line for line in done.stderr.splitlines() if line.startswith(str(inputs))]
            trace = self.folder / f"{flaw}.tried.rtr"
            words = ["--target", f"machine:{flaw}"]
            if run("repro", "machine", tried[-1], *words, "--out", trace)[0] == 1:
                code, _, err = run("shrink", trace, *words)
                if code == 0:
                    return tried[-1]
                self.assertEqual(code, 3, err)
                self.assertIn("a decision leaves open", err)
            for path in tried:  # It was one of the replay's own mutants of the last one.
                os.remove(path)

    def test_from_the_fuzzer_to_a_trace(self):
        for flaw, rules in FLAWS.items():
            with self.subTest(flaw):
                found = self.find(flaw)
                target = f"machine:{flaw}"
                trace = self.folder / f"{flaw}.rtr"
                code, _, err = run("repro", "machine", found, "--target", target, "--out", trace)
                self.assertEqual(code, 1, err)
                self.assertIn("; Broken by " + target, trace.read_text())
                self.assertEqual(run("test", "--target", "machine", trace)[0], 0)
                code, out, _ = run("test", "--target", target, trace)
                self.assertEqual(code, 1, out)
                broken = set(re.search(r"Broken: (.*)", out)[1].replace(",", " ").split())
                self.assertTrue(broken & rules, out)
                small = self.folder / f"{flaw}.small.rtr"
                code, _, err = run("shrink", trace, "--target", target, "--out", small)
                self.assertEqual(code, 0, err)
                self.assertLess(len(small.read_text()), len(trace.read_text()))
                self.assertEqual(run("test", "--target", "machine", small)[0], 0)
                self.assertEqual(run("test", "--target", target, small)[0], 1)


class Whole(Folder):
    def test_a_seed_breaks_nothing_and_is_its_case_again(self):
        for seed in write_seeds(self.folder / "seeds")[::40]:
            trace = self.folder / "seed.rtr"
            for fuzzer in ("machine", "nodes"):
                code, _, err = run("repro", fuzzer, seed, "--out", trace)
                self.assertEqual((code, err), (0, "nothing is broken\n"), seed)
            code, out, _ = run("repro", "machine", seed)
            self.assertEqual(code, 0)
            trace.write_text(out)
            self.assertEqual(run("test", "--target", "machine", trace)[0], 0, seed)

    def test_network(self):
        walk = self.write("walk", bytes([0]) + bytes(range(200)))
        code, out, err = run("repro", "network", walk)
        self.assertEqual((code, err), (0, "nothing is broken\n"))
        self.assertIn("join_request", out)
        chance = random.Random(2)
        for _ in range(40):
            walk.write_bytes(bytes([0]) + chance.randbytes(300))
            code, out, err = run("repro", "network", walk, "--target", "machine:acks_wrong_seq")
            if code == 1:
                break
        self.assertEqual(code, 1)
        self.assertIn("; Broken: ", out)
        (self.folder / "walk.rtr").write_text(out)
        code, out, err = run("check", self.folder / "walk.rtr")
        self.assertEqual(code, 1, err)
        self.assertIn("J4-SEQ", out)

    def test_what_makes_no_sense(self):
        for words, code in [(["machine", "nowhere"], 66), (["no_fuzzer", "x"], 64),
                            (["machine", SEEDS, "--target", "machine:none"], 64), ([], 64)]:
            self.assertEqual(run("repro", *words)[0], code, words)
        self.assertEqual(run("repro", "machine", SEEDS, "--out", self.folder)[0], 74)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
