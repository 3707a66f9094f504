#!/usr/bin/env python3
"""Tests of `rubric explore` as a program: verdicts, exit codes, formats, where traces go, and the
state diagrams against those that were read and found right.

Usage: explore_test.py RUBRIC [--regenerate]: writes tools/tests/test/expect anew; read
the difference.
"""

import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import unittest

from testing import RUBRIC, Folder, ProgramTest, run

DIAGRAMS = pathlib.Path(__file__).resolve().parent / "expect/transitions.txt"
FAULTS = ["--loss", "--dup"]


def explore(*words):
    return run("explore", *words, text=True)


class Explore(Folder):
    def test_says_what_it_found(self):
        done = explore("--motes", "1", "--sinks", "2", *FAULTS)
        self.assertEqual(done.returncode, 0, done.stderr)
        # The machine decides how many; explorer_test has one network's exact numbers.
        self.assertRegex(done.stdout, r"states +[1-9]\d{2,}\n")
        self.assertRegex(done.stdout, r"transitions +[1-9]\d{2,}\n")
        for line in ("depth        ", "bytes a state", "million states/s", "missed",
                     "second_offer", "verdict      holds"):
            self.assertIn(line, done.stdout)
        self.assertEqual(done.stderr, "")  # No progress where stderr is no terminal.

    def test_reductions_can_be_switched_off(self):
        found = {}
        for words in [], ["--no-partial-order"], ["--no-partial-order", "--no-symmetry"]:
            done = explore("--motes", "2", *FAULTS, *words, "--format", "json")
            self.assertEqual(done.returncode, 0, done.stderr)
            found[len(words)] = json.loads(done.stdout)
        by_mote, orbits, plain = found[0], found[1], found[2]
        self.assertEqual([f["by_mote"] for f in (by_mote, orbits, plain)], [True, False, False])
        self.assertLess(by_mote["states"], orbits["states"])
        self.assertLess(orbits["states"], plain["states"])
        self.assertEqual(orbits["represented_states"], plain["states"])
        self.assertEqual(by_mote["reached"], plain["reached"])
        self.assertEqual(plain["omission_probability"], 0)
        text = explore("--motes", "2", *FAULTS, "--no-partial-order").stdout
        self.assertIn(f"stand for    {plain['states']} states", text)
        self.assertIn("order        one mote's steps", explore("--motes", "2", *FAULTS).stdout)

    def test_liveness(self):
        done = explore(*FAULTS, "--liveness")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"liveness +101 states, [1-9]\d* parts")

    def test_a_flaw_is_found(self):
        """explorer_test finds each of them."""
        words = ["--calls", "2", *FAULTS, "--format", "json"]
        done = explore(*words, "--flaw", "accepts_wrong_seq")
        self.assertEqual(done.returncode, 1, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual((found["verdict"], found["broken"][0], found["flaw"]),
                         ("broken", "joined_after_reply", "accepts_wrong_seq"))
        self.assertTrue(found["trace"].startswith("%rtr 1"))
        honest = explore(*words)
        self.assertEqual(honest.returncode, 0, honest.stdout)
        self.assertIsNone(json.loads(honest.stdout)["trace"])

    def test_a_trace_on_stdout_is_alone_there(self):
        done = explore(*FAULTS, "--flaw", "no_fail")
        self.assertEqual(done.returncode, 1)
        self.assertTrue(done.stdout.startswith("%rtr 1"))
        self.assertIn("verdict      broken", done.stderr)

    def test_a_trace_goes_to_its_file(self):
        path = self.folder / "broken.rtr"
        self.shows(("explore", *FAULTS, "--flaw", "no_fail", "--out", path), "verdict      broken",
                   code=1)
        self.assertIn("case explore.one_terminal", path.read_text())
        done = explore(*FAULTS, "--flaw", "no_fail", "--out", self.folder / "none/x")
        self.assertEqual(done.returncode, 74)
        self.assertIn("cannot write", done.stderr)

    def test_only_the_asked_properties_count(self):
        words = ["--calls", "2", *FAULTS, "--flaw", "joined_on_link_ack", "--format", "json"]
        done = explore(*words, "--property", "joined_after_reply")
        self.assertEqual(json.loads(done.stdout)["broken"], ["joined_after_reply"])
        done = explore(*words, "--property", "one_report", "--property", "queues_bounded")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_closed_pipe_ends_it_without_a_word(self):
        process = subprocess.Popen([RUBRIC, "explore", *FAULTS, "--flaw", "no_fail"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.close()
        self.assertNotIn("cannot write", process.stderr.read())
        process.stderr.close()
        self.assertEqual(process.wait(), 74)

    def test_the_known_weakness_is_reported_and_breaks_nothing(self):
        path = self.folder / "known.rtr"
        self.shows(("explore", *FAULTS, "--reboot", "--calls", "2", "--out-known", path),
                   "spec/membership.md")
        text = path.read_text()
        self.assertIn("reboot", text)
        self.assertIn("case explore.known_weakness", text)

    def test_what_was_never_reached_fails(self):
        # A mote that misreads every ack breaks nothing of this; but no message ends in success.
        done = explore("--scope", "full", "--loss", "--flaw", "misread_acks", "--property",
                       "one_report", "--format", "json")
        self.assertEqual(done.returncode, 1)
        found = json.loads(done.stdout)
        self.assertEqual((found["verdict"], found["never"]), ("vacuous", ["acked"]))

    def test_a_flaw_that_never_acts_decides_nothing(self):
        # One call has no old replies that the mote could mistake for its own.
        self.shows(("explore", *FAULTS, "--flaw", "accepts_wrong_seq"),
                   "verdict      inconclusive: flaw accepts_wrong_seq never acted", "--calls 2",
                   code=3)
        found = json.loads(explore(*FAULTS, "--flaw", "accepts_wrong_seq", "--format",
                                   "json").stdout)
        self.assertEqual(found["verdict"], "inconclusive")
        self.assertIn("never acted", found["limit"])
        # One that acts, but breaks nothing of what was asked, is judged.
        done = explore("--calls", "2", *FAULTS, "--flaw", "accepts_wrong_seq", "--property",
                       "queues_bounded")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_limit_is_inconclusive(self):
        done = explore("--motes", "2", *FAULTS, "--max-states", "300")
        self.assertEqual(done.returncode, 3)
        self.assertIn("verdict      inconclusive: as many states", done.stdout)
        depth = re.search(r"^depth +(\d+)$", done.stdout, re.M)[1]
        self.assertIn(f"proved       no property is broken in fewer than {depth} moves",
                      done.stdout)

    def test_memory_is_a_limit(self):
        network = ["--motes", "3", "--sinks", "2", *FAULTS, "--threads", "2", "--no-symmetry",
                   "--no-partial-order"]
        process = subprocess.Popen([RUBRIC, "explore", *network, "--memory", "60M"],
                                   stdout=subprocess.PIPE, text=True)
        out = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stdout.close()
        self.assertEqual(process.returncode, 3)
        self.assertIn("verdict      inconclusive: more memory than --memory allows", out)
        self.assertIn("proved       no property is broken", out)
        self.assertLess(usage.ru_maxrss, 60 << 10)
        done = subprocess.run([RUBRIC, "explore", *network], capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS,
                                                                    (400 << 20, 400 << 20)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("verdict      inconclusive: more memory than the system has", done.stdout)

    def test_usage(self):
        for words, text in [(["--flaw", "no_fial"], "did you mean 'no_fail'"),
                            (["--flaw", "foo"], "--flaw: expected one of accepts_wrong_seq, "),
                            (["--property", "one_terminl"], "did you mean 'one_terminal'"),
                            (["--property", "foo"], "--property: expected one of "),
                            (["--flaw", "time_of_boot"], "time is abstract"),
                            (["--flaw", "misread_acks"], "--scope full"),
                            (["--profile", "papr"], "did you mean 'paper'"),
                            (["--motes", "9"], "--motes"),
                            (["--max-states", "-1"], "--max-states: expected a whole number of 0"),
                            (["--motes", "4", "--sinks", "4"], "at most 6"),
                            (["--lss"], "did you mean '--loss'")]:
            with self.subTest(words=words):
                self.refused(("explore", *words), text)


class Transitions(ProgramTest):
    def test_are_those_that_were_read(self):
        done = explore("--transitions")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout, DIAGRAMS.read_text())

    def test_json(self):
        done = explore("--transitions", "--part", "join", "--format", "json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual((found["schema"], found["profile"], found["flaw"]),
                         ("rubric.transitions/1", "paper", None))
        part, = found["parts"]
        self.assertEqual((part["name"], part["complete"]), ("join", True))
        self.assertGreater(part["worlds"], 1000)
        stray, = [t for t in part["transitions"] if t["rules"] == ["J4-SEQ"]]
        self.assertEqual((stray["trigger"], stray["guards"], stray["outputs"], stray["ignored"]),
                         ("join_reply", ["another number"], [], True))
        self.assertEqual(stray["from"], stray["to"])
        self.assertTrue(stray["witness"][-1].startswith("heard join_reply(island_addr=1"))
        self.assertTrue(stray["witness"][0].startswith("called join("))

    def test_dot(self):
        done = explore("--transitions", "--format", "dot")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(re.findall(r"^digraph (\w+)", done.stdout, re.M),
                         ["join", "listing", "message", "output", "input", "mote_reception",
                          "sink_reception"])
        self.assertEqual(explore("--format", "dot").returncode, 64)

    def test_a_flaw_shows(self):
        done = explore("--transitions", "--part", "join", "--flaw", "accepts_wrong_seq")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("another number: ignored", done.stdout)
        self.assertIn("join_reply / joined(success), ack_join", done.stdout)

    def test_usage(self):
        for words, text in [(["--transitions", "--part", "jion"], "did you mean 'join'"),
                            (["--part", "join"], "--transitions"),
                            (["--transitions", "--motes", "2"], "--transitions")]:
            self.refused(("explore", *words), text)


if __name__ == "__main__":
    if "--regenerate" in sys.argv:
        DIAGRAMS.write_text(explore("--transitions").stdout)
    else:
        unittest.main()
