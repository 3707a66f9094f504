#!/usr/bin/env python3
"""The Java base station at the serial line of `rubric run sink`: its forwarder, and its device.

Usage: run_java_test.py RUBRIC JAVA CLASSES. All of it on this host's loopback.
"""

import select
import subprocess
import sys
import time
import unittest

from live_testing import LiveTest, Running
from run_test import Node
from serial_testing import PATIENCE_S

COMMAND = [sys.argv[1], "-cp", sys.argv[2], "rubric.basestation.ForwarderClient"]
del sys.argv[1:3]


class Java(LiveTest):
    program = Node

    def station(self, port):
        self.process = subprocess.Popen([*COMMAND, f"localhost:{port}", "11"],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)

        def end():
            self.process.kill()
            self.process.communicate()
        self.addCleanup(end)
        self.said("op_result(success)")

    def said(self, text):
        """The next line of the station with this text."""
        deadline = time.monotonic() + PATIENCE_S
        while select.select([self.process.stdout], [], [], deadline - time.monotonic())[0]:
            line = self.process.stdout.readline().decode()
            if text in line:
                return line
            self.assertTrue(line, f"it ended without {text}")
        raise AssertionError(f"no {text}")

    def lives_with(self, sink, air, kept):
        """A mote joins, is heard, and opens its door."""
        mote = self.started("mote", "--id", "5", "--radio", air, "--app", "-")
        mote.call("join", type=1, transducers=3, actuators=2)
        mote.event("joined", success=True)
        self.said("received(11:5 10 x")  # serial_joined
        mote.call("send", dest="11:65533", app_id=10, reliable=True, data="0a0b")
        number = mote.event("send_result", success=True)["seq_num"]
        self.said("received(11:5 10 x0a0b)")
        mote.event("ack_received", seq_num=number, success=True)
        self.process.stdin.write(b"send(dest=11:5 app_id=10 reliable=1 data=x" +
                                 b"OPEN_DOOR".hex().encode() + b")\n")
        mote.event("received", src="11:65533", data=b"OPEN_DOOR".hex())
        self.said("ack_received(10 ")
        for node in (mote, sink):
            self.assertEqual(node.end()[0], 0)
        self.passes(kept)

    def sink(self, serial):
        kept = self.folder / "run.pcapng"
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial", serial,
                            "--write", kept)
        return sink, "zep:" + sink.waits_for(rb"zep:(\d+)\n"), kept

    def test_a_forwarder(self):
        sink, air, kept = self.sink("sf-server:0")
        self.station(sink.waits_for(rb"sf-server:(\d+)\n"))
        sink.waits_for(rb"(connected)")
        self.lives_with(sink, air, kept)

    def test_a_serial_device(self):
        """The program in Java knows forwarders alone, so one is between."""
        sink, air, kept = self.sink("pty")
        device = sink.waits_for(rb"(serial@/dev/\S+)")
        self.program = Running
        forward = self.started("forward", device, "--port", "0")
        self.program = Node
        self.station(forward.text_lines(1)[0].rpartition(":")[2])
        self.lives_with(sink, air, kept)


if __name__ == "__main__":
    unittest.main()
