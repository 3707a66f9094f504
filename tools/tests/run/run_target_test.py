#!/usr/bin/env python3
"""Other implementations as motes of a virtual air: `rubric run mote --target`.

Usage: run_target_test.py RUBRIC TARGET... All of it on this host's loopback.
"""

import sys
import unittest

from run_test import IslandTest
from testing import ROOT, rubric

TARGETS = sys.argv[1:]
del sys.argv[1:]
MOTE = ("run", "mote", "--id", "5", "--radio", "zep:0")

# A target that only lets time pass.
NO_CALLS = """
import sys
for line in sys.stdin:
    words = line.split()
    print({"hello": "hello rct/1 x 1 roles=mote time=virtual", "reset": "ready",
           "until": f"next -\\ndone {words[-1]}"}.get(words[0], "unsupported that"), flush=True)
"""


class Targets(IslandTest):
    def island_with(self, target):
        kept, log = self.folder / "run.pcapng", self.folder / "mote.rtr"
        sink, base, air = self.island(kept)
        mote = self.started("mote", "--id", "5", "--radio", air, "--app", "-", "--seed", "2",
                            "--target", target, "--log", log)
        mote.call("join", type=1, transducers=3, actuators=2)
        mote.event("joined", own="11:5", success=True)
        sink.event("mote_joined", mote="11:5")
        base.event("received", src="11:5")
        ours = self.started("mote", "--id", "6", "--radio", air, "--app", "-", "--seed", "3")
        ours.call("join", type=1, transducers=1, actuators=1)
        ours.event("joined", own="11:6", success=True)
        return sink, base, mote, ours, (kept, log)

    def test_they_live_in_an_island(self):
        for target in TARGETS:
            with self.subTest(target=target):
                sink, base, mote, ours, kept = self.island_with(target)
                mote.call("send", dest="11:6", app_id=10, reliable=True, data="0102")
                number = mote.event("send_result", success=True)["seq_num"]
                ours.event("received", src="11:5", app_id=10, data="0102")
                mote.event("ack_received", seq_num=number, success=True)
                base.call("send", dest="11:5", app_id=10, reliable=True,
                          data=b"OPEN_DOOR".hex())
                number = base.event("send_result", success=True)["seq_num"]
                mote.event("received", src="11:65533", data=b"OPEN_DOOR".hex())
                base.event("ack_received", seq_num=number, success=True)
                ours.call("create_in", src="11:5", size=1, power_save=False)
                ours.call("start", channel="5->6")
                mote.call("create_out", dest="11:6", size=1, power_save=False)
                mote.event("channel_result", channel="5->6", success=True)
                mote.call("write_output", channel="5->6", pos=0, value=1.5)
                mote.call("start", channel="5->6")
                ours.event("syn_data", channel="5->6", status="new")
                ours.call("read_input", channel="5->6", pos=0)
                self.assertEqual(ours.event("input_value", success=True)["value"], 1.5)
                for node in (mote, ours, base, sink):
                    self.assertEqual(node.end()[0], 0)
                for one in kept:
                    self.passes(one)
                    one.unlink()

    def test_clear_errors(self):
        for target, code, text in (("false", 66, "false: `hello rct/1`: ended with status 1"),
                                   ("read x; echo hello rct/1 x 1 roles=mote time=real", 64,
                                    "whose clock can be turned"),
                                   ("machine:flies", 64, "flies")):
            self.refused((*MOTE, "--target", target), text, code)

    def test_a_call_that_is_unsupported(self):
        """It is an error for who called, and the node goes on."""
        target = f"python3 {ROOT}/conformance/adapters/python/adapter.py"
        sink = self.started("sink", "--island", "11", "--radio", "zep:0")
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        mote = self.started("mote", "--id", "5", "--radio", air, "--app", "-", "--target", target)
        mote.call("set_island_id", island=12)
        self.assertIn("unsupported", mote.lines(1)[0]["text"])
        mote.call("join", type=1, transducers=3, actuators=2)
        mote.event("joined", own="11:5", success=True)

    def test_a_mote_of_a_file_that_breaks(self):
        script = self.write("target.py", NO_CALLS)
        plan = self.write("islands.yaml", "islands:\n  - island: 11\n    radio: zep:0\n    motes:\n"
                          f"      - {{id: 5, target: exec python3 {script}}}\n")
        code, _, err = rubric("run", plan)
        self.assertEqual(code, 66, err)
        self.assertRegex(err, "rubric: mote11_5: .*: unsupported: ")

    def test_a_mote_that_breaks(self):
        command = ("read x; echo hello rct/1 x 1 roles=mote time=virtual; read x; echo ready; "
                   "echo broken >&2; false")
        self.refused((*MOTE, "--target", command), "broken\n", 66)


if __name__ == "__main__":
    unittest.main()
