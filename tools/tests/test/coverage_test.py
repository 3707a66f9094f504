#!/usr/bin/env python3
"""Every rule has its case, and `rubric coverage` would say so if one had not.

Usage: coverage_test.py RUBRIC
"""

import json
import sys
import unittest

from testing import Folder, ROOT, run

CASES = ROOT / "conformance/cases"

ONE_CASE = """%rtr 1
%profile paper
%node m5 mote id=5 iut
case x.request
   0      m5 < app join(telosb_demo light led)
   0..300 m5 > rA  join_request(*)  [{}]
"""


def coverage(folder, *options):
    return run("coverage", "--cases", folder, *options, text=True)


class Coverage(Folder):
    def one_case(self, rule):
        (self.folder / "x.rtr").write_text(ONE_CASE.format(rule), encoding="utf-8")
        return coverage(self.folder, "--format", "json")

    def test_every_must_has_a_case(self):
        done = coverage(CASES)
        own = run("coverage", cwd=self.folder, text=True)  # Without a checkout.
        self.assertEqual((own.returncode, own.stdout), (done.returncode, done.stdout))
        problems = [line for line in done.stdout.splitlines() if line.startswith("problem")]
        self.assertEqual((done.returncode, problems), (0, []), done.stderr)

    def test_json_says_the_same(self):
        report = json.loads(coverage(CASES, "--format", "json").stdout)
        self.assertEqual(report["schema"], "rubric.coverage/1")
        self.assertEqual(report["problems"], [])
        rules = {rule["id"]: rule for rule in report["rules"]}
        self.assertEqual(len(rules), report["totals"]["rules"])
        self.assertGreater(rules["J4-SEQ"]["negative"], 0)
        self.assertGreater(rules["J4-SEQ"]["ignores"], 0)
        self.assertTrue(rules["J4-SEQ"]["explored"])
        self.assertGreater(rules["J4-SEQ"]["mutants"], 0)
        self.assertGreater(report["wire"]["MUST"], 0)
        for rule in report["rules"]:
            self.assertGreater(rule["mutants"], 0, rule["id"])

    def test_a_missing_case_is_a_problem(self):
        done = self.one_case("J1-REQUEST")
        problems = json.loads(done.stdout)["problems"]
        self.assertEqual(done.returncode, 1)
        self.assertIn("J8-RETRY is a MUST without a case", problems)
        self.assertIn("J1-SEQ forbids, but no case attempts it", problems)
        self.assertNotIn("J1-REQUEST is a MUST without a case", problems)

    def test_an_orphan_is_a_problem(self):
        done = self.one_case("J99-NOTHING")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("J99-NOTHING", done.stdout + done.stderr)

    def test_another_protocols_rules_are_counted(self):
        ctp = ROOT / "conformance/protocols/ctp"
        done = run("coverage", "--protocol", ctp, "--format", "json", text=True)
        report = json.loads(done.stdout)
        self.assertEqual((done.returncode, report["problems"]), (0, []), done.stderr)
        rules = {rule["id"]: rule for rule in report["rules"]}
        self.assertEqual(len(rules), 44)
        self.assertGreater(rules["LOOP-DATA"]["positive"], 0)
        self.assertIsNone(rules["LOOP-DATA"]["mutants"])  # There is no machine for it.
        text = run("coverage", "--protocol", ctp, text=True).stdout
        self.assertEqual(len(text.splitlines()), 1 + 44 + 1)
        columns = {line.find(" MUST") for line in text.splitlines() if " MUST " in line}
        self.assertEqual(len(columns), 1, text)

    def test_another_protocols_missing_case_is_a_problem(self):
        probes = self.folder / "probes"
        run("new-protocol", "probes", cwd=self.folder)
        self.assertEqual(run("coverage", "--protocol", probes).returncode, 0)
        rules = probes / "requirements.yaml"
        rules.write_text(
            rules.read_text(encoding="utf-8")
            + '\n- id: NEW-RULE\n  level: MUST\n  clause: new\n'
            + '  sentence: "A node does something new."\n  source: "a test"\n',
            encoding="utf-8",
        )
        done = run("coverage", "--protocol", probes, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("problem: NEW-RULE is a MUST without a case", done.stdout)
        rules.unlink()
        self.refused(("coverage", "--protocol", probes), "requirements.yaml", 66)

    def test_no_cases_are_an_error(self):
        done = coverage(self.folder)
        self.assertEqual(done.returncode, 66)
        self.assertIn("no .rtr file", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
