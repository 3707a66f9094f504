#!/usr/bin/env python3
"""`rubric test` as its users meet it: what it runs, and how it explains what fails.

Usage: test_test.py RUBRIC in the project's folder.
"""

import json
import pathlib
import re
import shlex
import unittest

from test_testing import CASES, HONEST, Folder, rubric, test


class Running(Folder):
    def test_machine_passes_anywhere(self):
        """The golden traces are in the program."""
        code, out, err = test("--target", "machine", cwd=self.folder)
        self.assertEqual((code, err), (0, ""))
        lines = out.splitlines()
        self.assertEqual(sum(line.startswith("pass  ") for line in lines), CASES)
        self.assertIn(f"rubric_machine: {CASES} pass.", out)
        self.assertIn("0 broken, 0 not decided.", out)
        self.assertTrue(out.endswith("Verdict: as expected: 0 unexpected results.\n"))

    def test_quiet_says_little(self):
        out = test("--target", "machine", "--quiet")[1]
        self.assertLess(len(out.splitlines()), 10)

    def test_roles_that_it_does_not_play(self):
        code, out, _ = test("--target", HONEST, "--jobs", "2")
        self.assertEqual(code, 0)
        self.assertRegex(out, r"SKIP \d+ cases: it plays no sink, only mote")
        self.assertRegex(out, r"skip +j3\.reply +it plays no sink, only mote")
        passed, skipped = map(int, re.search(r": (\d+) pass, (\d+) skip\.", out).groups())
        self.assertEqual(passed + skipped, CASES)
        self.assertGreater(passed, 100)

    def test_jobs_change_nothing(self):
        target = self.impatient_mote()
        one = test("--target", target, "--role", "mote")[1]
        self.assertEqual(one, test("--target", target, "--role", "mote", "--jobs", "3")[1])
        self.assertIn("FAIL j8.", one)

    def test_shards_are_all_of_it(self):
        names = []
        for i in (1, 2, 3):
            out = test("--list", "--shard", f"{i}/3")[1]
            names += [line.split()[0] for line in out.splitlines()]
        self.assertEqual(len(set(names)), CASES)
        self.assertEqual(len(names), CASES)

    def test_traces_of_the_user(self):
        trace = self.write("own.rtr", "%rtr 1\n%node m5 mote id=5 iut\ncase own.clock\n"
                           "  0 m5 < app get_clock()\n  0..50 m5 > app clock(ms=0..9)\n")
        code, out, _ = test("--target", "machine", trace)
        self.assertEqual(code, 0)
        self.assertIn("rubric_machine: 1 pass.", out)
        trace.write_text(trace.read_text().replace("0..9", "7"))
        code, out, _ = test("--target", "machine", trace)
        self.assertEqual(code, 1)
        self.assertIn(f"line 5 of {trace}", out)
        self.assertIn(f"--cases own.clock {trace}\n", out)

    def test_several_targets(self):
        code, out, _ = test("--target", "machine", "--target", self.impatient_mote(),
                            "--requirement", "J8")
        self.assertEqual(code, 1)
        self.assertIn("rubric_machine 1 plays mote, sink, base_station", out)
        self.assertIn("rubric_python_mote 1.0 plays mote", out)
        self.assertRegex(out, r"rubric_machine: \d+ pass\.")

    def test_seeds_of_repeats(self):
        args = ["--target", "machine", "--cases", "j4.accept", "--format", "json"]
        report = json.loads(test(*args, "--seed", "5", "--repeat", "3")[1])
        cases = report["implementations"][0]["cases"]
        self.assertEqual([(c["repeat"], c["seed"]) for c in cases], [(0, 5), (1, 6), (2, 7)])
        self.assertIn("seq_num=2285", "".join(cases[0]["log"]))  # 1000 + 257 * 5
        self.assertIn("seq_num=2542", "".join(cases[1]["log"]))

    def test_profile(self):
        """Differences of release 1.0 that its profile accepts are expected, its faults are not."""
        code, out, _ = test("--target", "machine", "--profile", "deployed")
        self.assertEqual(code, 0, out)
        self.assertIn("EXPECTED FAIL t3.timeout: T3-TIMEOUT:", out)
        self.assertIn("A reliable message without its ack is never signalled as failed.",
                      " ".join(out.split()))
        self.assertIn("EXPECTED FAIL j8.at_most_five: J8-LIMIT:", out)
        target = self.mote_with("if number != self.request or device", "if device")
        code, out, _ = test("--target", target, "--role", "mote", "--profile", "deployed")
        self.assertEqual(code, 1)
        self.assertIn("\nFAIL j4.wrong_seq\n", out)


class Failing(Folder):
    def test_failure_is_explained(self):
        target = self.mote_with("if number != self.request or device", "if device")
        code, out, _ = test("--target", target, "--role", "mote", "--quiet")
        self.assertEqual(code, 1)
        for words in ["fail         j4.wrong_seq", "\nFAIL j4.wrong_seq\n",
                      "  Catches a mote that takes any reply for its own",
                      "(MUST J4-SEQ; paper: Component Management)",
                      "  Forbids:  b+2..99 m5 !> rA ack_join(*) [J4-SEQ]\n",
                      "of conformance/cases/j4.rtr, from tick 2 to 99 (2.0 ms to 96.7 ms)",
                      "  But:      at 2 it emitted rA ack_join(", "    > @2        m5 > rA am=5->1",
                      "<<<\n", "  Broken: J4-ACK J4-SEQ J5-ACCEPT\n", "1 unexpected result."]:
            self.assertIn(words, out)

    def test_missing_output_is_marked_where_it_should_be(self):
        out = test("--target", self.fake("mute"), "--cases", "j1.request")[1]
        self.assertIn("  But:      it emitted nothing there\n", out)
        self.assertIn("    > @0..300   no join_request that is as the line says\n", out)
        self.assertRegex(out, r"300 .*\*.*no join_request  <<<\n")

    def test_a_mute_adapter_passes_nothing_that_asks_for_something(self):
        report = json.loads(test("--target", self.fake("mute", "mote,sink,base_station"),
                                 "--format", "json")[1])
        passed = {c["name"] for c in report["implementations"][0]["cases"]
                  if c["verdict"] == "pass"}
        listed = {line.split()[0] for line in test("--list")[1].splitlines()}
        asks = set()
        for path in pathlib.Path("conformance/cases").rglob("*.rtr"):
            name = None
            for line in path.read_text().splitlines():
                if line.startswith("case "):
                    name = line.split()[1]
                elif name and not line.lstrip().startswith(";") and re.search(r"\s > ", line):
                    asks.add(name)
        self.assertEqual(passed & asks, set())
        self.assertGreater(len(listed & asks), 200)

    def test_again_shows_it_again(self):
        out = test("--target", self.impatient_mote(), "--requirement", "J8", "--seed", "3",
                   "--verbose")[1]
        commands = re.findall(r"^  Again:    rubric (.*)$", out, re.M)
        self.assertGreater(len(commands), 0)
        for command in commands:
            code, again, err = rubric(*shlex.split(command))
            self.assertEqual((code, err), (1, ""), command)
            name = re.search(r"--cases (\S+)", command)[1]
            self.assertIn(f"\nFAIL {name}\n", again)

    def test_crash_is_an_error_of_its_case(self):
        code, out, err = test("--target", self.fake("dies"), "--cases", "j1.*")
        self.assertEqual((code, err), (2, ""))
        self.assertIn("\nERROR j1.request\n", out)
        self.assertIn("    | out of memory ?[31m at 0x1234\n", out)
        self.assertRegex(out, r"Broke: +.*signal 6")
        self.assertRegex(out, r"fake: \d+ pass, \d+ error\.")
        self.assertIn("Verdict: broken: 0 unexpected results, ", out)

    def test_hang_is_an_error_of_its_case(self):
        code, out, _ = test("--target", self.fake("hangs"), "--cases", "j1.request", "--cases",
                            "j10.mote*", "--timeout", "0.3")
        self.assertEqual(code, 2)
        self.assertRegex(out, r"error +j1\.request ")
        self.assertRegex(out, r"(error|pass) +j10\.mote")

    def test_nonsense_is_an_error(self):
        code, out, _ = test("--target", self.fake("babbles"), "--cases", "j1.request")
        self.assertEqual(code, 2)
        self.assertIn("hi there", out)

    def test_unable_is_skipped(self):
        code, out, _ = test("--target", self.fake("unable"), "--cases", "j1.request")
        self.assertEqual(code, 3)
        self.assertIn("no calls", out)
        self.assertIn("nothing was decided", out)

    def test_dishonest_is_refused(self):
        for target, why in [(self.fake("yes_man"), "a command that nobody knows"),
                            (self.fake("liar"), "canary.mote has to fail"),
                            ("exit 3", "it does not start"),
                            ("no_such_program_anywhere", "it does not start"),
                            ("cat", "it does not start")]:
            code, out, _ = test("--target", target)
            self.assertEqual(code, 2, target)
            self.assertTrue(out.startswith("REFUSED "), out)
            self.assertIn(why, " ".join(out.split()))
            self.assertIn("so nothing was run.", " ".join(out.split()))
            self.assertNotRegex(out, r"(?m)^(pass|fail|error) ")


if __name__ == "__main__":
    unittest.main()
