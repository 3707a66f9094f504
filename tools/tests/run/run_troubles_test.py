#!/usr/bin/env python3
"""`rubric run` where nodes are not heard, send too much, or meet others at their places.

Usage: run_troubles_test.py RUBRIC. All of it on this host's loopback.
"""

import re
import socket
import struct
import time
import unittest

from run_test import IslandTest
from testing import ROOT

LEARNING = 6
STARTS, STOPS, CLOCK, OUTGOING, INCOMING, ANSWER, OUTPUT = 1, 2, 8, 9, 10, 23, 25


class Troubles(IslandTest):
    def test_a_channel_is_set_up_from_afar(self):
        """The PC creates, starts and stops it by commands of the Learning Layer, which the
        applications on mote and sink obey (decision 142)."""
        hospital = ROOT / "conformance/node/examples/hospital.py"
        kept = self.folder / "run.rtr"
        run = self.started(self.write("islands.yaml", f"""
islands:
  - island: 11
    radio: zep:0
    serial: sf-server:0
    sink_app: python3 {hospital} sink
    motes:
      - {{id: 2, app: python3 {hospital} mote}}
"""), "--log", kept)
        serial = run.waits_for(rb"(sf@127.0.0.1:\d+)\n")
        base = self.started("base-station", "--island", "11", "--sink", serial, "--app", "-")
        base.waits_for(rb"(connected)")
        run.event("mote_joined", mote="11:2")
        number = 0

        def command(dest, data, reliable=True):
            nonlocal number
            number += 1
            base.call("send", dest=dest, app_id=LEARNING, reliable=reliable,
                      data=(data + struct.pack(">H", number)).hex())
            # After what the sink had sent before.
            base.event("received", src=dest, app_id=LEARNING,
                       data=struct.pack(">BHB", ANSWER, number, 0).hex())

        def data_come():
            while not base.event("received", src="11:1")["data"].startswith(f"{OUTPUT:02x}01"):
                pass

        ends = struct.pack(">6H", 11, 2, 11, 1, 0, 0) + 2 * struct.pack(">B10H", 1, *10 * [7])
        for dest, code in (("11:1", INCOMING), ("11:2", OUTGOING)):
            command(dest, bytes([code]) + ends + b"\0")
            command(dest, struct.pack(">BH", CLOCK, 250))
        command("11:1", struct.pack(">BH", STARTS, 0))
        for reliable in (True, False):
            command("11:2", struct.pack(">BH", STARTS, 0), reliable)
            data_come()
            command("11:2", struct.pack(">BH", STOPS, 0), reliable)
            time.sleep(0.6)
        for node in (base, run):
            self.assertEqual(node.end()[0], 0)
        report = self.judged(kept)
        exercised = {one["requirement"] for one in report["exercised"]}
        self.assertLessEqual({"T1-DELIVER", "T2-ACK", "S2-CONTENT", "S2-SIGNAL"}, exercised)
        # A channel speaks from a start to a stop, after which one message may have waited.
        said = re.findall(r"mote11_2 +(?:< +app +(start|stop)_all|> +r1 .*(syn)_channel)",
                          kept.read_text(encoding="utf-8"))
        told = "".join(one or "D" for one, _ in said)
        self.assertRegex(told, "^(startD+stopD?){2}$")

    def test_a_mote_that_its_base_station_does_not_hear_is_there(self):
        """One sends to its sink alone, one sends nothing; both are asked (decision 124)."""
        robot = ROOT / "conformance/node/examples/robot.py"
        run = self.started(self.write("islands.yaml", f"""
islands:
  - island: 11
    radio: zep:0
    sink_app: python3 {robot} watch 11:8
    motes:
      - {{id: 6}}
      - {{id: 8, app: python3 {robot} drive}}
"""), "--gone-after", "4", "--log", self.folder / "run.rtr")
        for _ in range(2):
            run.event("mote_joined", node="sink11")
        time.sleep(9)
        code, out, err = run.end()
        self.assertEqual(code, 0, err)
        self.assertNotIn("mote_left", run.read.decode() + out)
        # No other application is told of the answer.
        self.assertNotIn("ack_received", run.read.decode() + out)
        self.passes(self.folder / "run.rtr")

    def test_a_sink_says_what_it_drops(self):
        sink, base, air = self.island(self.folder / "run.pcapng")
        mote = self.started("mote", "--id", "5", "--radio", air)
        mote.event("joined", success=True)
        base.event("received", src="11:5")
        for _ in range(300):
            base.call("send", dest="11:5", app_id=10, reliable=False, data="0a")
        self.assertGreater(int(sink.waits_for(
            rb"sink11: (\d+) messages from the serial line were dropped")), 0)
        self.assertEqual(sink.end()[0], 0)

    def why(self, node, **what):
        """Why a message is refused."""
        node.call("send", **{"dest": "11:1", "app_id": 10, "reliable": False, "data": "", **what})
        return node.event("send_result", success=False)["why"]

    def test_a_message_that_is_refused(self):
        mote = self.started("mote", "--id", "5", "--radio", "zep:0", "--app", "-")
        self.assertEqual(self.why(mote), "the mote has not joined")
        self.assertEqual(self.why(mote, data=101 * "00"), "more than 100 bytes of data")
        base = self.started("base-station", "--island", "11", "--sink", "sf@127.0.0.1:1", "--app",
                            "-")
        self.assertEqual(self.why(base, dest="11:65533"), "no line of this node leads there")
        for _ in range(8):
            base.call("send", dest="11:5", app_id=10, reliable=True, data="")
        self.assertEqual(self.why(base, reliable=True),
                         "as many acknowledgements are awaited as can be")
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--app", "-")
        # At once, so that the radio has no time to send.
        sink.process.stdin.write(8 * b'{"call":"send","dest":"11:5","app_id":10,"reliable":false,'
                                     b'"data":""}\n')
        sink.process.stdin.flush()
        self.assertEqual([sink.event("send_result") for _ in range(8)][-1]["why"],
                         "the outgoing buffer is full")
        sink.call("interface", link="radio", on=False)
        self.assertEqual(self.why(sink, dest="11:5"), "the line is switched off")

    def test_two_sinks_on_an_air(self):
        one = self.started("sink", "--island", "11", "--radio", "zep:0")
        air = "zep:" + one.waits_for(rb"zep:(\d+)\n")
        two = self.started("sink", "--island", "11", "--radio", air)
        two.waits_for(rb"zep:(\d+)\n")  # On the air, so that it answers the mote, too.
        mote = self.started("mote", "--id", "5", "--radio", air, "--app", "-")
        mote.call("join", type=1, transducers=1, actuators=1)
        mote.event("joined", success=True)
        for _ in range(5):
            mote.call("send", dest="11:1", app_id=10, reliable=True, data="0a")
            mote.event("ack_received")
        # Neither ends before both have said so: what one has heard of the other may come before
        # its own first frame has gone, which waits for the air.
        for sink in (one, two):
            sink.waits_for(rb"(sink11: another sink is on this air)")
        for sink in (one, two):
            self.assertEqual(sink.end()[0], 0)

    def test_a_port_that_another_program_holds(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.bind(("127.0.0.1", 0))
            port = other.getsockname()[1]
            mote = self.started("mote", "--id", "5", "--radio", f"zep:{port}")
            self.assertIn(str(port), mote.waits_for(
                rb"zep:(\d+): the port is held by a program that does not answer"))
            self.assertEqual(mote.end()[0], 0)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.bind(("127.0.0.2", port))
            mote = self.started("mote", "--id", "5", "--radio", f"zep:127.0.0.2:{port}")
            mote.waits_for(rb"(zep:127.0.0.2:\d+: nothing there answers as an air does)")
            self.assertEqual(mote.end()[0], 0)
        hub = self.started("mote", "--id", "5", "--radio", f"zep:{port}", "--app", "-")
        hub.waits_for(rb"(zep:\d+\n)")
        mote = self.started("mote", "--id", "6", "--radio", f"zep:{port}", "--app", "-")
        time.sleep(2.5)
        self.assertNotIn("held", mote.end()[2])


if __name__ == "__main__":
    unittest.main()
