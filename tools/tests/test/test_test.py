#!/usr/bin/env python3
"""`rubric test` as its users meet it: what it runs, and how it explains what fails.

Usage: test_test.py RUBRIC in the project's folder.
"""

import contextlib
import json
import os
import pathlib
import re
import shlex
import signal
import socket
import subprocess
import threading
import time
import unittest

from test_testing import CASES, HONEST, Folder, comes, is_dead, rubric, sleeps, test
from testing import RUBRIC

# A mute adapter. One of two ends when the other is to play node 7, which does so after that end.
PAIR = """
import os, pathlib, sys, threading, time
folder, me = pathlib.Path(sys.argv[1]), os.getpid()
(folder / f"pid.{me}").touch()
def end():
    while not any(path.suffix != f".{me}" for path in folder.glob("seven.*")): time.sleep(0.01)
    os._exit(5)
threading.Thread(target=end, daemon=True).start()
def is_dead(pid):
    return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
for line in sys.stdin:
    words = line.split()
    if words[0] == "hello": print("hello rct/1 pair 1 roles=mote")
    elif words[0] == "bye": break
    elif words[0] == "frobnicate": print("unsupported")
    elif words[0] == "reset":
        if "id=7" in words:
            (folder / f"seven.{me}").touch()
            others = [int(path.suffix[1:]) for path in folder.glob("pid.*")]
            while not all(is_dead(pid) for pid in others if pid != me): time.sleep(0.01)
        print("ready")
    else: print("done", words[1])
    sys.stdout.flush()
"""


# Records the conversation with an adapter; without one it answers as recorded, whatever is asked.
TAPE = """
import subprocess, sys
log, adapter = sys.argv[1], sys.argv[2:]
if adapter:
    other = subprocess.Popen(adapter[0], shell=True, text=True, bufsize=1,
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    tape = open(log, "w")
else:
    answers = iter(open(log).read().split("\\f"))
for line in sys.stdin:
    if line.startswith("bye"): break
    answer = ""
    if adapter:
        other.stdin.write(line)
        while answer.rpartition("\\n")[0].rpartition("\\n")[2].split(" ")[0] not in (
                "hello", "ready", "done", "unsupported"):
            answer += other.stdout.readline()
        tape.write(answer + "\\f")
    else: answer = next(answers)
    print(answer, end="", flush=True)
"""


class Station(threading.Thread):
    """Connects to a Serial Forwarder, sends a config message if there is one, and listens."""

    def __init__(self, port, config):
        super().__init__(daemon=True)
        self.port, self.packet = port, bytes([0, 0, 1, 0, 0, len(config), 0, 37]) + config

    def __enter__(self):
        self.start()

    def __exit__(self, *_):
        self.join(10)

    def run(self):
        while True:
            with contextlib.suppress(ConnectionRefusedError):
                line = socket.create_connection(("127.0.0.1", self.port))
                break
            time.sleep(0.02)
        with line:
            line.sendall(b"U ")
            line.recv(2)
            time.sleep(0.3)
            if len(self.packet) > 8:
                line.sendall(bytes([len(self.packet)]) + self.packet)
            while line.recv(4096):
                pass


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
        self.shows(("test", "--target", "machine", trace), "rubric_machine: 1 pass.")
        trace.write_text(trace.read_text().replace("0..9", "7"))
        self.shows(("test", "--target", "machine", trace), f"line 5 of {trace}",
                   f"--cases own.clock {trace}\n",
                   "\nFAIL own.clock\n  Rule:     none; the set-up of this case", code=1)
        # A line of the list is whole where nobody said how wide it may be.
        trace.write_text(trace.read_text().replace("0..50", "2147483000..2147483648"))
        code, out, _ = test("--target", "machine", trace)
        self.assertEqual(code, 2)
        says = "2147483000..2147483648 is too late: a case ends by tick 2147483647 (24 days)"
        self.assertRegex(out, rf"(?m)^error +own.clock +{re.escape(says)}$")
        self.assertIn(f"\nERROR own.clock\n  Broke:    {says}\n", out)
        out = test("--target", "machine", "--width", "90", trace)[1]
        self.assertRegex(out, r"(?m)^error +own.clock .{49,}\.\.\.$")

    def test_what_is_stated_moves_the_windows(self):
        """A mote with timers of its own passes when it states them, in hello or by --state."""
        slow = self.mote_with("JOIN_PERIOD = 500", "JOIN_PERIOD = 1024")
        some = ["--role", "mote", "--rule", "J", "--quiet"]
        self.assertEqual(test("--target", slow, *some)[0], 1)
        code, out, _ = test("--target", slow, "--state", "join_period=1024", *some)
        self.assertEqual(code, 0, out)
        self.assertIn("; states join_period=1024", " ".join(out.split()))
        states = (self.folder / "mote/adapter.py")
        states.write_text(states.read_text().replace("virtual", "virtual join_period=1024"))
        self.assertEqual(test("--target", slow, *some)[0], 0)
        # These words count more than hello, and an implementation must keep what it states.
        code, out, _ = test("--target", slow, "--state", "join_period=500", *some)
        self.assertEqual(code, 1)
        self.shows(("test", "--target", HONEST, "--state", "ack_timeout=2000", "--cases",
                    "t3.timeout"), "T3-TIMEOUT", code=1)
        self.assertEqual(test("--target", "machine", "--state", "ack_timeout=2000", "--state",
                              "response=350")[0], 0)

    def test_times_that_channel_access_explains(self):
        """A verdict says so once, and names what to state; it stays what it is."""
        few = ["--cases", "j8.retry", "--cases", "j8.lost_reply", "--quiet"]
        for period, told in (("495", True), ("450", False), ("1024", False)):
            mote = self.mote_with("JOIN_PERIOD = 500", "JOIN_PERIOD = " + period)
            code, out, _ = test("--target", mote, *few)
            self.assertEqual(code, 1)
            self.assertEqual("2 failed cases would pass with --state channel_access=30" in
                             " ".join(out.split()), told, out)
            self.assertEqual(test("--target", mote, "--state", "channel_access=30", *few)[0],
                             0 if told else 1)

    def test_stated_values_that_a_case_is_not_for(self):
        out = test("--target", "machine", "--state", "join_requests=7", "--cases", "j8.*")[1]
        self.assertRegex(" ".join(out.split()),
                         r"skip j8\.at_most_five the case is for join_requests=5")
        code, out, _ = test("--target", "machine", "--state", "channels=1", "--rule", "S")
        self.assertEqual(code, 0, out)
        self.assertIn("the case is for channels=2..8, and channels=1 is stated",
                      " ".join(out.split()))
        # Who states the longest list is tried with one mote more than it can list.
        out = test("--target", "machine", "--state", "members=20", "--cases", "j3.full_list")[1]
        self.assertRegex(out, r"rubric_machine: 1 pass\.")

    def test_statements_that_make_no_sense(self):
        for word, why in (("ack_timout=2000", "known are response, join_period, join_requests"),
                          ("response=0", "expected response from 1 to 1500 ticks"),
                          ("response", "expected response from 1 to 1500 ticks")):
            code, _, err = test("--target", "machine", "--state", word)
            self.assertEqual(code, 64, word)
            self.assertIn(why, " ".join(err.split()))
        self.refused(("test", "--target", "machine", "--state", "response=9", "--state",
                      "response=9"), "response is stated twice")

    def test_several_targets(self):
        out = self.shows(("test", "--target", "machine", "--target", self.impatient_mote(),
                          "--rule", "J8"), "rubric_machine 1 plays mote, sink, base_station",
                         "rubric_python_mote 1.0 plays mote", code=1)
        self.assertRegex(out, r"rubric_machine: \d+ pass\.")

    def test_seeds_of_repeats(self):
        args = ["--target", "machine", "--cases", "j4.accept", "--format", "json"]
        report = json.loads(test(*args, "--seed", "5", "--repeat", "3")[1])
        cases = report["implementations"][0]["cases"]
        self.assertEqual([(c["repeat"], c["seed"]) for c in cases], [(0, 5), (1, 6), (2, 7)])
        self.assertIn("seq_num=2285", "".join(cases[0]["log"]))  # 1000 + 257 * 5
        self.assertIn("seq_num=2542", "".join(cases[1]["log"]))

    def test_seeds_that_would_be_others_are_refused(self):
        args = ["--target", "machine", "--cases", "j4.accept"]
        self.assertEqual(test(*args, "--seed", "65535")[0], 0)
        for more in (["--seed", "65536"], ["--seed", "65535", "--repeat", "2"],
                     ["--seed", "18446744073709551615", "--repeat", "2"]):
            self.refused(("test", *args, *more), "65535")

    def test_list_as_json(self):
        code, out, _ = test("--list", "--format", "json", "--rule", "J4-SEQ")
        listed = json.loads(out)
        self.assertEqual((code, listed["schema"]), (0, "rubric.test.list/1"))
        lines = test("--list", "--rule", "J4-SEQ")[1].splitlines()
        self.assertEqual([one["name"] for one in listed["cases"]],
                         [line.split()[0] for line in lines])
        for one in listed["cases"]:
            self.assertEqual(list(one), ["name", "file", "comment", "roles", "rules"])
            self.assertIn("J4-SEQ", one["rules"])
            self.assertTrue(pathlib.Path(one["file"]).exists())
        self.assertEqual(test("--list", "--format", "tap")[0], 64)

    def test_a_glob_that_is_not_true_is_one_line(self):
        known = self.write("known.yaml", "- {case: 'j4.*', requirement: J4, message: x, reason: y}")
        code, out, _ = test("--target", "machine", "--cases", "j4.*", "--expect", known)
        self.assertEqual(code, 1)
        self.assertEqual(out.count("NOT TRUE"), 1)
        self.assertIn("1 expectation not true", out)
        self.assertIn("runs that 'j4.*' names do not fail so", " ".join(out.split()))

    def test_cases_beyond_reach_are_one_sentence(self):
        """An adapter may show some links of its node only."""
        partial = f"{HONEST} | sed -u s/time=virtual/'& links=app,serial'/"
        code, out, _ = test("--target", partial, "--role", "mote", "--rule", "J8")
        self.assertEqual(code, 3)
        self.assertNotRegex(out, "(?m)^inconclusive ")
        self.assertRegex(out, r"The attached links decide 0 of \d+ cases; the others need radio as")
        self.assertRegex(out, r"INCONCLUSIVE \d+ cases: the target does not show radio")
        self.refused(("test", "--target", HONEST, "--app", "true"),
                     "an app goes with sf-server, sf or serial")

    def test_a_base_station_that_never_tells_its_island(self):
        """What it does is judged, but the run is incomplete: it may have told its sink before."""
        for tells, code in ((b"\x0a\x00\x0b", 0), (b"\x0a\x00\x0c", 3), (b"", 3)):
            with socket.create_server(("127.0.0.1", 0)) as server:
                port = server.getsockname()[1]
            with Station(port, tells):
                got, out, err = test("--target", f"sf-server:{port}", "--cases",
                                     "t1.base_station_line")
            self.assertEqual(got, code, out + err)
            self.assertIn("base_station_at_forwarder: 1 pass.", out)
            self.assertEqual("Incomplete: N9-SET is not decided, for it did not tell its sink the "
                             "island, from its first case to its last" in " ".join(out.split()),
                             code == 3)

    def test_nobody_at_the_port(self):
        """It is not waited for longer than --timeout says, whatever starts slowly elsewhere."""
        for target in ("sf:127.0.0.1:1", "serial:tcp:127.0.0.1:1", "sf:127.0.0.1:1:mote"):
            before = time.monotonic()
            code, out, _ = test("--target", target, "--timeout", "0.2")
            self.assertEqual(code, 2)
            self.assertIn("Connection refused", " ".join(out.split()))
            self.assertLess(time.monotonic() - before, 10)

    def test_profile(self):
        """Differences of release 1.0 that its profile accepts are expected, its faults are not."""
        out = self.shows(("test", "--target", "machine", "--profile", "deployed"),
                         "EXPECTED FAIL t3.timeout: T3-TIMEOUT:")
        self.assertIn("A reliable message without its ack is never signalled as failed.",
                      " ".join(out.split()))
        self.assertIn("EXPECTED FAIL j8.at_most_five: J8-LIMIT:", out)
        target = self.mote_with("if number != self.request or device", "if device")
        self.shows(("test", "--target", target, "--role", "mote", "--profile", "deployed"),
                   "\nFAIL j4.wrong_seq\n", code=1)


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
                      "<<<\n", "  Broken: J4-SEQ\n",
                      "  Suspected: J4-ACK J4-CLOCK J8-RETRY J8-FAIL\n",
                      "  Then:     line 40 [J4-ACK]: ", "5 unexpected results."]:
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
        out = test("--target", self.impatient_mote(), "--rule", "J8", "--seed", "3",
                   "--verbose")[1]
        commands = re.findall(r"^  Again:    rubric (.*)$", out, re.M)
        self.assertGreater(len(commands), 0)
        for command in commands:
            code, again, err = rubric(*shlex.split(command))
            self.assertEqual((code, err), (1, ""), command)
            name = re.search(r"--cases (\S+)", command)[1]
            self.assertIn(f"\nFAIL {name}\n", again)

    def test_crash_is_a_failure_of_its_case(self):
        code, out, err = test("--target", self.fake("dies"), "--cases", "j1.*")
        self.assertEqual((code, err), (1, ""))
        self.assertIn("\nFAIL j1.request\n", out)
        self.assertIn("(MUST J1-REQUEST; ", " ".join(out.split()))
        self.assertIn("    | out of memory \ufffd[31m at 0x1234\n", out)
        self.assertRegex(out, r"Broke: +.*signal 6")
        self.assertRegex(out, r"fake: \d+ pass, \d+ fail\.")
        self.assertIn("Verdict: not as expected: ", out)

    def test_crash_can_be_expected(self):
        args = ["--target", self.fake("dies"), "--cases", "j1.request", "--expect"]
        known = "- {case: j1.request, requirement: J1-REQUEST, message: 'signal 6', reason: x}"
        self.assertEqual(test(*args, self.write("known.yaml", known))[0], 0)
        for other in (known.replace("J1-REQUEST", "J4-SEQ"), known.replace("signal 6", "signal 9")):
            self.assertEqual(test(*args, self.write("known.yaml", other))[0], 1)

    def test_hang_is_a_failure_of_its_case(self):
        code, out, _ = test("--target", self.fake("hangs"), "--cases", "j1.request", "--cases",
                            "j10.mote*", "--timeout", "0.3")
        self.assertEqual(code, 1)
        self.assertRegex(out, r"fail +j1\.request +J1-REQUEST: gave no answer")
        self.assertRegex(out, r"(fail|pass) +j10\.mote")

    def test_bad_end_is_a_note(self):
        self.shows(("test", "--target", self.fake("bad_end"), "--cases", "j10.mote*"),
                   "  Note: it ended with status 1, after `bye`.\n", "    | could not save\n")

    def test_end_between_cases_is_seen(self):
        trace = self.write("two.rtr", "%rtr 1\n"
                           "case two.pair\n%node m5 mote id=5 iut\n%node m6 mote id=6 iut\n"
                           "  0..50 m5 !> app *\n"
                           "case two.alone\n%node m7 mote id=7 iut\n  0..50 m7 !> app *\n")
        pair = self.write("pair.py", PAIR)
        for form in ("text", "json", "junit", "tap"):
            place = self.folder / form
            place.mkdir()
            out = self.shows(("test", "--target", f"exec python3 {pair} {place}", trace, "--format",
                              form), "ended with status 5", code=2)
            if form == "text":
                self.assertIn("pair: 2 pass.", out)
                self.assertIn("  Broke: it ended with status 5, after its last case.\n", out)
                self.assertIn("1 implementation broke between cases", " ".join(out.split()))

    def test_signals_end_what_is_attached(self):
        cases = "conformance/cases/j10.rtr"
        for number, (signal_number, command) in enumerate([
                (signal.SIGINT, ["test", cases]), (signal.SIGTERM, ["test", cases]),
                (signal.SIGHUP, ["test", cases]), (signal.SIGINT, ["shrink", cases]),
                (signal.SIGTERM, ["diff", cases, "--target", "machine"])]):
            at = self.folder / f"pid{number}"
            target = f"{self.fake('stubborn')} {at}"
            run = subprocess.Popen([RUBRIC, *command, "--target", target, "--timeout", "3000"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(run.wait)
            self.addCleanup(run.kill)
            self.assertTrue(comes(at.exists))
            pid = int(at.read_text())
            self.assertFalse(is_dead(pid))
            run.send_signal(signal_number)
            self.assertEqual(run.wait(timeout=60), -signal_number)
            self.assertTrue(comes(lambda: is_dead(pid)))

    def test_kill_ends_what_is_attached(self):
        """By SIGKILL, against which nothing can be done; also what has left its session."""
        for number, command in enumerate((["test", "--jobs", "2"], ["shrink"],
                                          ["diff", "--target", "machine"])):
            at = self.folder / f"pid{number}"
            seconds = f"1000.{os.getpid()}{number}"
            target = f"setsid sleep {seconds} & {self.fake('stubborn')} {at}"
            run = subprocess.Popen(
                [RUBRIC, *command, "conformance/cases/j10.rtr", "--target", target,
                 "--timeout", "3000"],
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(run.wait)
            self.addCleanup(run.kill)
            self.assertTrue(comes(at.exists))
            pid = int(at.read_text())
            self.assertTrue(sleeps(seconds))
            run.kill()
            self.assertTrue(comes(lambda: is_dead(pid) and not sleeps(seconds)))

    def test_hang_up_under_nohup(self):
        at = self.folder / "pid"
        run = subprocess.Popen(
            ["nohup", RUBRIC, "test", "--target", f"{self.fake('stubborn')} {at}", "--cases",
             "j10.mote*", "--timeout", "3000"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        self.assertTrue(comes(at.exists))
        pid = int(at.read_text())
        run.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(run.poll())
        self.assertFalse(is_dead(pid))
        run.send_signal(signal.SIGTERM)
        self.assertEqual(run.wait(timeout=60), -signal.SIGTERM)
        self.assertTrue(comes(lambda: is_dead(pid)))

    def test_nonsense_is_a_failure(self):
        code, out, _ = test("--target", self.fake("babbles"), "--cases", "j1.request")
        self.assertEqual(code, 1)
        self.assertRegex(out, r"fail +j1\.request +J1-REQUEST: ")
        self.assertIn("hi there", out)

    def test_unable_is_skipped(self):
        self.shows(("test", "--target", self.fake("unable"), "--cases", "j1.request"), "no calls",
                   "nothing was decided", code=3)

    def test_undecided_is_not_green(self):
        """A few cases of silence pass; all others are owed unless the file says why not."""
        code, out, _ = test("--target", self.fake("unable"), "--quiet")
        self.assertEqual(code, 3)
        self.assertRegex(out, r"Incomplete: \d+ cases are neither decided nor listed")
        self.assertRegex(out, r"Verdict: incomplete: 0 unexpected results, \d+ cases not decided\.")
        known = self.folder / "known.yaml"
        test("--target", self.fake("unable"), "--write-expect", known)
        self.assertIn("# Not decided: call join: no calls", known.read_text())
        again = ["--target", self.fake("unable"), "--expect", known]
        self.refused(("test", *again), "reason is empty: say why this is known")
        known.write_text(known.read_text().replace('reason: ""', "reason: It can do nothing."))
        code, out, _ = test(*again)
        self.assertEqual(code, 0, out)
        self.assertIn("as listed: It can do nothing.", " ".join(out.split()))
        self.assertEqual(test(*again, "--require-rules", "100")[0], 3)
        self.assertEqual(test(*again, "--write-expect", known)[0], 0)
        self.assertEqual(test(*again)[0], 0, "reasons are kept")

    def test_what_the_app_of_a_line_refuses_is_not_green(self):
        """The line may leave a case open; an app that answers `unsupported` has not decided it."""
        app = f"{self.fake('unable', 'base_station')} | sed -u s/time=virtual/time=real/"
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
        node = subprocess.Popen([RUBRIC, "run", "base-station", "--island", "11", "--sink",
                                 f"sf@127.0.0.1:{port}"], stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            self.shows(("test", "--target", f"sf-server:{port}", "--app", app, "--cases",
                        "t1.base_station_line", "--cases", "t4.base_station_serial"),
                       "1 pass, 1 skip", "1 case is neither decided nor listed", code=3)
        finally:
            node.terminate()
            node.wait()

    def test_a_written_list_is_read_again(self):
        """Its comments are comments, however long a rule's sentence is."""
        known = self.folder / "known.yaml"
        run = ["--target", "machine:joined_on_link_ack", "--cases", "j4.*"]
        self.assertEqual(test(*run, "--write-expect", known)[0], 1)
        lines = known.read_text().splitlines()
        self.assertTrue(all(re.match(r"#|- |  |$", line) for line in lines), lines)
        self.assertTrue(any(a.startswith("# J4-") and b.startswith("# ")
                            for a, b in zip(lines, lines[1:])), "no sentence was wrapped")
        known.write_text(known.read_text().replace('reason: ""', "reason: It takes any reply."))
        self.assertEqual(test(*run, "--expect", known)[0], 0)

    def test_a_recording_does_not_pass_with_another_seed(self):
        log = self.folder / "log"
        cases = ["--cases", "j4.*"]
        target = f"exec python3 {self.write('tape.py', TAPE)} {log}"
        self.assertEqual(test("--target", f"{target} {shlex.quote(HONEST)}", *cases)[0], 0)
        self.assertEqual(test("--target", target, *cases)[0], 0)
        code, out, _ = test("--target", target, *cases, "--seed", "7")
        self.assertEqual(code, 1)  # Before the first case it has lost its place.
        self.assertRegex(out, r"(?m)^fail +j4\.")

    def test_dishonest_is_refused(self):
        for target, why in [(self.fake("yes_man"), "an unknown command"),
                            (self.fake("liar"), "canary.mote has to fail"),
                            ("exit 3", "it does not start"),
                            ("no_such_program_anywhere", "a shell that finds no such command"),
                            ("cat", "it does not start")]:
            code, out, _ = test("--target", target)
            self.assertEqual(code, 2, target)
            self.assertTrue(out.startswith("REFUSED "), out)
            self.assertIn(why, " ".join(out.split()))
            self.assertIn("so nothing was run.", " ".join(out.split()))
            self.assertNotRegex(out, r"(?m)^(pass|fail|error) ")


if __name__ == "__main__":
    unittest.main()
