#!/usr/bin/env python3
"""The test of seeded bugs itself: it accepts no list with mistakes, and sees bugs not found.

A stand-in for rubric reports that an implementation breaks the rules listed in its file `broken`;
SHOULD-... is one that it should keep.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TEST = pathlib.Path(__file__).parent / "seeded_bugs_test.py"
STAND_IN = """#!/usr/bin/env python3
import json, pathlib, sys
rules = pathlib.Path(sys.argv[sys.argv.index("--target") + 1], "broken").read_text().split()
weak = all(rule.startswith("SHOULD-") for rule in rules)
cases = [{"name": "j1.x", "verdict": "pass", "failures": []}]
if rules:
    cases.append({"name": "j4.y", "verdict": "weak" if weak else "fail",
                  "failures": [{"requirements": rules, "suspected": []}]})
report = {"implementations": [{"cases": cases}]}
pathlib.Path(sys.argv[sys.argv.index("--out") + 1]).write_text(json.dumps(report))
sys.exit(0 if weak else 1)
"""
GOOD = {"name": "a", "file": "broken", "old": "\n", "new": "J4-SEQ\n", "requirement": "J4-SEQ"}


class SeededBugs(unittest.TestCase):
    def try_bugs(self, bugs, tree_text="\n", build=""):
        with tempfile.TemporaryDirectory() as folder:
            base = pathlib.Path(folder)
            (base / "rubric").write_text(STAND_IN)
            (base / "rubric").chmod(0o755)
            (base / "tree").mkdir()
            (base / "tree/broken").write_text(tree_text)
            (base / "tree/bugs.json").write_text(json.dumps(bugs))
            done = subprocess.run(
                [sys.executable, TEST, "--bugs", base / "tree/bugs.json", "--rubric",
                 base / "rubric", "--target", "{dir}", "--build", build],
                capture_output=True, text=True)
            self.assertEqual((base / "tree/broken").read_text(), tree_text)
            return done.returncode, done.stdout + done.stderr

    def test_found(self):
        code, text = self.try_bugs([GOOD])
        self.assertEqual(code, 0, text)
        self.assertIn("a: J4-SEQ in j4.y", text)

    def test_not_found(self):
        for new in ("", "J4-ACK\n"):
            code, text = self.try_bugs([{**GOOD, "new": new}, {**GOOD, "name": "b"}])
            self.assertEqual(code, 1, text)
            self.assertIn("2 bugs, 1 not found", text)

    def test_weak(self):
        weak = {**GOOD, "new": "SHOULD-X\n", "requirement": "SHOULD-X", "verdict": "weak"}
        code, text = self.try_bugs([weak])
        self.assertEqual(code, 0, text)
        self.assertIn("a: SHOULD-X in j4.y", text)
        for change in ({"verdict": "fail"}, {"new": "SHOULD-X J4-SEQ\n"}, {"new": "SHOULD-Y\n"},
                       {"new": ""}):
            with self.subTest(change):
                code, text = self.try_bugs([{**weak, **change}])
                self.assertEqual(code, 1, text)
                self.assertIn("1 bugs, 1 not found", text)

    def test_mistakes_in_the_list(self):
        for bugs, tree, why in (
                ([], "\n", "not a list of bugs"),
                ([{**GOOD, "why": "x"}], "\n", "has not just"),
                ([{"name": "a"}], "\n", "has not just"),
                ([{**GOOD, "verdict": "pass"}], "\n", "neither fail nor weak"),
                ([GOOD, GOOD], "\n", "more than one bug is called a"),
                ([{**GOOD, "old": "absent"}], "\n", "occurs 0 times"),
                ([GOOD], "\n\n", "occurs 2 times"),
                ([{**GOOD, "new": "\n"}], "\n", "changes nothing"),
                ([{**GOOD, "file": "gone"}], "\n", "there is no gone"),
                ([GOOD], "J1-DEST\n", "without a bug rubric test ended with 1")):
            with self.subTest(why):
                code, text = self.try_bugs(bugs, tree)
                self.assertEqual(code, 2, text)
                self.assertIn(why, text)

    def test_build(self):
        self.assertEqual(self.try_bugs([GOOD], build="test -f {dir}/broken")[0], 0)
        code, text = self.try_bugs([GOOD], build="echo wrong; exit 1")
        self.assertEqual(code, 2)
        self.assertIn("it does not build:\nwrong", text)


if __name__ == "__main__":
    unittest.main()
