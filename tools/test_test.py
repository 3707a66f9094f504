#!/usr/bin/env python3
"""`rubric test` as its users meet it.

Usage: test_test.py RUBRIC in the project's folder.
"""

import json
import os
import pathlib
import pty
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

RUBRIC = os.path.abspath(sys.argv.pop(1))
MOTE = pathlib.Path("conformance/adapters/python")
HONEST = f"python3 {MOTE}/adapter.py"
CASES = sum(line.startswith("case ") for path in pathlib.Path("conformance/cases").rglob("*.rtr")
            for line in path.read_text().splitlines())

# An adapter that does nothing, and breaks as its first argument says.
FAKE = '''
import os, sys, time
how = sys.argv[1]
for line in sys.stdin:
    words = line.split()
    if words[0] == "hello":
        if how == "silent_start": time.sleep(60)
        print("hello rct/1 fake 1.0 roles=" + (sys.argv[2] if len(sys.argv) > 2 else "mote")
              + " time=virtual")
    elif words[0] == "reset":
        print("ready")
    elif words[0] == "bye":
        break
    elif words[0] not in ("rx", "call", "linkack", "line", "power", "until"):
        print("done 0" if how == "yes_man" else "unsupported what is that")
    elif words[0] == "call" and words[2].startswith("join(") and how == "liar":
        print("up %s joined(10053:5 success)" % words[1])
        print("done " + words[1])
    elif words[0] == "call" and how == "unable":
        print("unsupported no calls")
    elif words[0] == "call" and how == "dies":
        print("out of memory \\x1b[31m at 0x1234", file=sys.stderr, flush=True)
        os.abort()
    elif words[0] == "call" and how == "hangs":
        time.sleep(60)
    elif words[0] == "call" and how == "babbles":
        print("hi there")
    else:
        print("done " + words[1])
    sys.stdout.flush()
'''


def rubric(*args, env=None, cwd=None):
    """Exit code, stdout, stderr as text."""
    done = subprocess.run([RUBRIC, *map(str, args)], capture_output=True, cwd=cwd, check=False,
                          env={**os.environ, "GITHUB_ACTIONS": "", **(env or {})})
    return done.returncode, done.stdout.decode(), done.stderr.decode()


def test(*args, **more):
    return rubric("test", *args, **more)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.fake_program = self.write("fake.py", FAKE)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def fake(self, how, roles="mote"):
        return f"exec python3 {self.fake_program} {how} {roles}"

    def mote_with(self, old, new):
        """The Python mote with another text in it."""
        folder = self.folder / "mote"
        folder.mkdir(exist_ok=True)
        for name in ("adapter.py", "mote.py"):
            text = (MOTE / name).read_text()
            if name == "mote.py":
                self.assertIn(old, text)
                text = text.replace(old, new)
            (folder / name).write_text(text)
        return f"exec python3 {folder}/adapter.py"

    def impatient_mote(self):
        return self.mote_with("JOIN_PERIOD = 500", "JOIN_PERIOD = 450")


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
        self.assertEqual(code, 1)
        self.assertIn("EXPECTED FAIL t3.timeout: T3-TIMEOUT:", out)
        self.assertIn("A reliable message without its ack is never signalled as failed.",
                      " ".join(out.split()))
        self.assertIn("\nFAIL j8.at_most_five\n", out)


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


class Expectations(Folder):
    ENTRY = "- case: j8.%s\n  requirement: J8\n  message: %s\n  reason: It is in a hurry.\n"

    def failing(self):
        report = json.loads(test("--target", self.impatient_mote(), "--requirement", "J8",
                                 "--format", "json")[1])
        return {c["name"]: c["failures"] for c in report["implementations"][0]["cases"]
                if c["verdict"] == "fail"}

    def against(self, text):
        return test("--target", self.impatient_mote(), "--requirement", "J8", "--expect",
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
        code, out, _ = test("--target", "machine", "--cases", name, "--expect",
                            self.folder / "known.yaml")
        self.assertEqual(code, 1)
        self.assertIn(f"pass         {name}", out)
        self.assertIn("was expected to fail", out)
        self.assertIn("1 expectation not true", out)

    def test_files_that_make_no_sense(self):
        code, _, err = self.against("- case: x\n")
        self.assertEqual(code, 64)
        self.assertIn("known.yaml:1: requirement is missing", err)
        code, _, err = test("--target", "machine", "--expect", self.folder / "none.yaml")
        self.assertEqual(code, 66)
        self.assertIn("No such file or directory", err)


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
        code, _, err = test(*target, "--out", "/dev/full")
        self.assertEqual(code, 2)
        self.assertIn("/dev/full", err)
        code, _, err = test(*target, "--report", "/dev/null/x")
        self.assertEqual(code, 2)
        self.assertNotEqual(err, "")

    def test_compare(self):
        """What changed since an earlier run."""
        args = ["--requirement", "J8", "--role", "mote"]
        test("--target", HONEST, *args, "--report", self.folder / "before")
        before = self.folder / "before" / "report.json"
        code, out, _ = test("--target", self.impatient_mote(), *args, "--compare", before)
        self.assertEqual(code, 1)
        self.assertIn(f"Since {before}: ", " ".join(out.split()))
        self.assertRegex(out, r"rubric_python_mote: j8\.\w+ was pass, is fail")
        out = test("--target", HONEST, *args, "--compare", before)[1]
        self.assertIn("0 cases with another verdict, 0 cases that it does not have.",
                      " ".join(out.split()))
        for text, says in [("{", "no JSON"), ("{}", "schema")]:
            code, _, err = test("--target", HONEST, "--compare", self.write("x.json", text))
            self.assertEqual(code, 66)
            self.assertIn(says, err)

    def test_times_on_terminals_and_when_asked_for(self):
        args = ["--target", "machine", "--cases", "j4.few"]
        self.assertNotRegex(test(*args)[1], r"in [0-9.]+ s\.")
        self.assertRegex(test(*args, "--verbose")[1], r"1 pass in [0-9.]+ s\.")

    def test_annotations_in_actions(self):
        _, _, err = test("--target", self.impatient_mote(), "--requirement", "J8",
                         env={"GITHUB_ACTIONS": "true"})
        self.assertIn("::error file=conformance/cases/j8.rtr,line=", err)

    def test_colours_only_on_terminals(self):
        args = ["test", "--target", "machine", "--cases", "j4.*"]
        self.assertNotIn("\033", rubric(*args)[1])
        self.assertIn("\033[32mpass\033[0m", rubric(*args, "--color", "always")[1])
        for env, coloured in [({"TERM": "xterm", "NO_COLOR": ""}, True),
                              ({"TERM": "xterm", "NO_COLOR": "1"}, False)]:
            ours, theirs = pty.openpty()
            with subprocess.Popen([RUBRIC, *args], stdout=theirs,
                                  env={**os.environ, **env}) as process:
                os.close(theirs)
                out = b""
                try:
                    while part := os.read(ours, 65536):
                        out += part
                except OSError:
                    pass  # The other end has closed.
            os.close(ours)
            self.assertEqual(process.returncode, 0)
            self.assertEqual(b"\033[" in out, coloured, env)


class Usage(Folder):
    def test_list(self):
        code, out, err = test("--list", "--requirement", "J4-SEQ")
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
            (["--target", "machine", "--requirement", "J44"], "no rule is called 'J44'"),
            (["--target", "machine", "--requirement", "WIRE-PCAP"], "no case tries WIRE-PCAP"),
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
            code, out, err = test(*args)
            self.assertEqual((code, out), (64, ""), args)
            self.assertIn(says, err)

    def test_unreadable(self):
        empty = self.folder / "empty"
        empty.mkdir()
        for traces, says in [
            (self.folder / "none.rtr", "no such file or folder"),
            (empty, "no .rtr file"),
            (self.write("bad.rtr", "%rtr 1\ncase x\n  0 m5 < app jion()\n"), "bad.rtr:3:"),
            (self.write("iut.rtr", "%rtr 1\n%node m5 mote id=5\ncase x\n"), "no node under test"),
        ]:
            code, out, err = test("--target", "machine", traces)
            self.assertEqual((code, out), (66, ""), traces)
            self.assertIn(says, err)

    def test_help(self):
        code, out, _ = test("--help")
        self.assertEqual(code, 0)
        for words in ["64 usage", "66 traces cannot be read", "--expect", "--shard"]:
            self.assertIn(words, out)


if __name__ == "__main__":
    unittest.main()
