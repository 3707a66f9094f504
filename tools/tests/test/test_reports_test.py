#!/usr/bin/env python3
"""`rubric test` as CI jobs meet it: expected failures, reports, exit codes.

Usage: test_reports_test.py RUBRIC in the project's folder.
"""

import json
import re
import unittest
import xml.etree.ElementTree

from test_testing import CASES, HONEST, Folder, rubric, test
from testing import on_terminal


class Expectations(Folder):
    def failing(self):
        report = json.loads(test("--target", self.impatient_mote(), "--rule", "J8",
                                 "--format", "json")[1])
        return {c["name"]: c["failures"] for c in report["implementations"][0]["cases"]
                if c["verdict"] == "fail"}

    def against(self, text):
        return test("--target", self.impatient_mote(), "--rule", "J8", "--expect",
                    self.write("known.yaml", text))

    def test_known(self):
        entries = "".join(
            "- case: %s\n  requirement: %s\n  message: %s\n  reason: It is in a hurry.\n" %
            (name, one["requirements"][0], json.dumps(one["text"]))
            for name, failures in self.failing().items() for one in failures)
        code, out, err = self.against(entries)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("EXPECTED FAIL ", out)
        self.assertIn("It is in a hurry.", out)
        self.assertNotRegex(out, r"(?m)^FAIL ")
        changed = entries.replace("reason:", "profile: deployed\n  reason:", 1)
        self.assertEqual(self.against(changed)[0], 1)

    def test_not_true(self):
        code, out, _ = self.against(
            "- {case: j8.gone, requirement: J8, message: x, reason: y}\n")
        self.assertEqual(code, 1)
        self.assertIn("NOT TRUE ", out)
        self.assertIn("known.yaml:1: no case is called 'j8.gone'", " ".join(out.split()))
        name = next(iter(self.failing()))
        code, out, _ = self.against(
            f"\n- {{case: {name}, requirement: J8, message: of other words, reason: y}}\n")
        self.assertEqual(code, 1)
        self.assertIn("known.yaml:2:", out)
        self.shows(("test", "--target", "machine", "--cases", name, "--expect",
                    self.folder / "known.yaml"), f"pass         {name}", "was expected to fail",
                   "1 expectation not true", code=1)

    def test_files_that_make_no_sense(self):
        code, _, err = self.against("- case: x\n")
        self.assertEqual(code, 64)
        self.assertIn("known.yaml:1: requirement is missing", err)
        self.refused(("test", "--target", "machine", "--expect", self.folder / "none.yaml"),
                     "No such file or directory", 66)


class Charts(Folder):
    def test_they_agree_with_the_text(self):
        """What the text says of a failure is marked in its chart and in the page's, no more."""
        target = ["--target", "machine:release_1_0_firmware"]
        folder = self.folder / "report"
        text = test(*target, "--verbose", "--report", folder)[1]
        page = (folder / "index.html").read_text(encoding="utf-8")
        data = json.loads(re.search(r'type="application/json" id="data">(.*?)</script>', page)[1])
        blocks = dict(re.findall(r"(?ms)^FAIL (\S+)\n(.*?)(?=^FAIL|^SKIP|^WEAK|\Z)", text))
        compared = 0
        for case in data["cases"]:
            failures = case["runs"][0]["failures"]
            if case["runs"][0]["verdict"] != "fail":
                continue
            compared += 1
            ticks = []
            time = None     # A row has none where it is that of the row before.
            for mark, row in re.findall(r'<g class="rc-row( rc-marked)?"(.*?)</g>',
                                        data["charts"][case["runs"][0]["chart"]], re.S):
                shown = re.search(r'class="rc-time"[^>]*>(\d+)<', row)
                time = int(shown[1]) if shown else time
                if mark:
                    ticks.append(time)
            self.assertEqual(set(ticks), {one["time_ticks"] for one in failures}, case["name"])
            marked = re.findall(r"(?m)^ +(\d+) .*<<<$", blocks[case["name"]])
            self.assertIn(failures[0]["time_ticks"], map(int, marked), case["name"])
            self.assertLessEqual(set(map(int, marked)), set(ticks), case["name"])
            said = " ".join(blocks[case["name"]].split())
            self.assertIn(" ".join(failures[0]["text"].split()), said)
        self.assertGreater(compared, 50)


class Formats(Folder):
    def test_json(self):
        code, out, err = test("--target", "machine", "--format", "json")
        self.assertEqual((code, err), (0, ""))
        report = json.loads(out)
        self.assertEqual(report["schema"], "rubric.test/1")
        self.assertEqual(len(report["implementations"][0]["cases"]), CASES)

    def test_junit_and_tap(self):
        out = test("--target", HONEST, "--format", "junit")[1]
        root = xml.etree.ElementTree.fromstring(out)
        cases = list(root.iter("testcase"))
        self.assertEqual(len(cases), CASES)
        self.assertEqual(len({c.get("name") for c in cases}), CASES)
        suite, = root
        self.assertEqual({**suite.attrib, "name": "rubric test"}, root.attrib)
        out = test("--target", HONEST, "--format", "tap")[1]
        self.assertIn("TAP version 13", out)
        self.assertIn(f"1..{CASES}", out)

    def test_out_and_report(self):
        target = ["--target", "machine", "--cases", "j4.*"]
        path = self.folder / "out.txt"
        code, out, _ = test(*target, "--out", path)
        self.assertEqual((code, out), (0, ""))
        self.assertEqual(path.read_text(), test(*target)[1])
        code, _, _ = test(*target, "--report", self.folder / "a" / "b")
        self.assertEqual(code, 0)
        report = json.loads((self.folder / "a" / "b" / "report.json").read_text())
        self.assertEqual(report["schema"], "rubric.test/1")
        xml.etree.ElementTree.parse(self.folder / "a" / "b" / "junit.xml")
        self.assertIn("j4.wrong_seq", (self.folder / "a" / "b" / "index.html").read_text())
        self.refused(("test", *target, "--out", "/dev/full"), "/dev/full", 74)
        code, _, err = test(*target, "--report", "/dev/null/x")
        self.assertEqual(code, 74)
        self.assertNotEqual(err, "")

    def test_compare(self):
        """The changes since an earlier run."""
        args = ["--rule", "J8", "--role", "mote"]
        test("--target", HONEST, *args, "--report", self.folder / "before")
        before = self.folder / "before" / "report.json"
        code, out, _ = test("--target", self.impatient_mote(), *args, "--compare", before)
        self.assertEqual(code, 1)
        self.assertIn(f"Since {before}: ", " ".join(out.split()))
        self.assertRegex(out, r"rubric_python_mote[ .\d]*: j8\.\w+ was pass, is fail")
        out = test("--target", HONEST, *args, "--compare", before)[1]
        self.assertIn("0 cases with another verdict, 0 new, 0 gone or not chosen.",
                      " ".join(out.split()))
        out = test("--target", HONEST, "--cases", "j8.at_most_five", "--cases", "j4.few",
                   "--compare", before)[1]
        self.assertRegex(" ".join(out.split()),
                         r"0 cases with another verdict, 1 new, [1-9]\d* gone")
        self.assertRegex(out, r"\n  rubric_python_mote[ .\d]*: j4\.few is new: pass\n")
        self.assertRegex(out, r"\n  rubric_python_mote[ .\d]*: j8\.\w+ is gone, was pass\n")
        for text, says in [("{", "not JSON"), ("{}", "schema")]:
            self.refused(("test", "--target", HONEST, "--compare", self.write("x.json", text)),
                         says, 66)

    def test_times_on_terminals_and_when_asked_for(self):
        args = ["--target", "machine", "--cases", "j4.few"]
        self.assertNotRegex(test(*args)[1], r"in [0-9.]+ s\.")
        self.assertRegex(test(*args, "--verbose")[1], r"1 pass in [0-9.]+ s\.")

    def test_annotations_in_actions(self):
        _, _, err = test("--target", self.impatient_mote(), "--cases", "j8.*",
                         env={"GITHUB_ACTIONS": "true"})
        self.assertIn("::error file=conformance/cases/j8.rtr,line=", err)

    def test_colours_only_on_terminals(self):
        args = ["test", "--target", "machine", "--cases", "j4.*"]
        self.assertNotIn("\033", rubric(*args)[1])
        self.assertIn("\033[32mpass\033[0m", rubric(*args, "--color", "always")[1])
        for env, coloured in [({"TERM": "xterm", "NO_COLOR": ""}, True),
                              ({"TERM": "xterm", "NO_COLOR": "1"}, False)]:
            code, out = on_terminal(*args, env=env)
            self.assertEqual(code, 0)
            self.assertEqual(b"\033[" in out, coloured, env)


class Usage(Folder):
    def test_list(self):
        code, out, err = test("--list", "--rule", "J4-SEQ")
        self.assertEqual((code, err), (0, ""))
        self.assertRegex(out, r"(?m)^j4\.wrong_seq +mote +.*J4-SEQ")
        for line in out.splitlines():
            self.assertIn("J4-SEQ", line)
        self.assertEqual(len(test("--list")[1].splitlines()), CASES)
        self.assertRegex(test("--list", "--role", "sink")[1], r"(?m)^home\.network +mote\+sink\+")

    def test_usage(self):
        for args, says in [
            ([], "--target is required"),
            (["--target", ""], "--target"),
            (["--target", "machine", "--cases", "j4.acept"], "did you mean 'j4.accept'?"),
            (["--target", "machine", "--rule", "J44"], "no rule is called 'J44'"),
            (["--target", "machine", "--rule", "WIRE-PCAP"], "no case tries WIRE-PCAP"),
            (["--target", "machine", "--cases", "j4.*", "--role", "base_station"], "no case has"),
            (["--target", "machine", "--role", "moat"], "--role"),
            (["--target", "machine", "--profile", "papr"], "--profile"),
            (["--target", "machine", "--shard", "3/2"], "expected I/N as in 2/8"),
            (["--target", "machine", "--cases", "j4.few", "--shard", "2/2"], "has no case"),
            (["--target", "machine", "--repeat", "0"], "--repeat"),
            (["--target", "machine", "--jobs", "-1"], "--jobs"),
            (["--target", "machine", "--seed", "-1"], "--seed"),
            (["--target", "machine", "--timeout", "0"], "--timeout"),
            (["--target", "machine", "--format", "html"], "--format"),
            (["--targt", "machine"], "did you mean '--target'?"),
        ]:
            self.refused(("test", *args), says)

    def test_unreadable(self):
        empty = self.folder / "empty"
        empty.mkdir()
        for traces, says in [
            (self.folder / "none.rtr", "No such file or directory"),
            (empty, "no .rtr file"),
            (self.write("bad.rtr", "%rtr 1\ncase x\n  0 m5 < app jion()\n"), "bad.rtr:3:"),
            (self.write("iut.rtr", "%rtr 1\n%node m5 mote id=5\ncase x\n"), "no node under test"),
        ]:
            self.refused(("test", "--target", "machine", traces), says, 66)

    def test_help(self):
        code, out, _ = test("--help")
        self.assertEqual(code, 0)
        for words in ["64 usage", "66 traces cannot be read", "--expect", "--shard"]:
            self.assertIn(words, out)


if __name__ == "__main__":
    unittest.main()
