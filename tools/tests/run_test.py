#!/usr/bin/env python3
"""`rubric run`: a sink, its base station and two motes on a virtual air, and what check says of it.

Usage: run_test.py RUBRIC PROJECT_FOLDER. All of it on this host's loopback. Each step waits for
what it needs, and only a bound of patience ends it otherwise.
"""

import json
import os
import re
import select
import socket
import subprocess
import time
import unittest

from live_testing import RUBRIC, LiveTest, Running, lines_of
from serial_testing import PATIENCE_S


class Node(Running):
    """A running node: what it says, and its calls."""

    def __init__(self, *arguments):
        super().__init__("run", *arguments, stdin=subprocess.PIPE)
        self.said = b""

    def waits_for(self, pattern):
        """The first group of the next text on stderr that matches."""
        deadline = time.monotonic() + PATIENCE_S
        while not (found := re.search(pattern, self.said)):
            left = max(0, deadline - time.monotonic())
            more = b""
            if select.select([self.process.stderr], [], [], left)[0]:
                more = os.read(self.process.stderr.fileno(), 4096)
            if not more:
                raise AssertionError(f"no {pattern} in {self.said}")
            self.said += more
        self.said = self.said[found.end():]
        return found.group(1).decode()

    def event(self, name, **fields):
        """The next event of that name with these fields."""
        while True:
            event = self.lines(1)[0]
            if event["event"] == "error":
                raise AssertionError(event)
            if event["event"] == name and fields.items() <= event.items():
                return event

    def call(self, call, **arguments):
        self.process.stdin.write(json.dumps({"call": call, **arguments}).encode() + b"\n")
        self.process.stdin.flush()


class Run(LiveTest):
    program = Node

    def island(self, kept):
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial",
                            "sf-server:0", "--seed", "1", "--write", kept)
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        serial = "sf@localhost:" + sink.waits_for(rb"sf-server:(\d+)\n")
        base = self.started("base-station", "--island", "11", "--sink", serial, "--app", "-")
        base.waits_for(rb"(connected)")
        return sink, base, air

    def test_an_island_keeps_the_rules(self):
        kept = self.folder / "run.pcapng"
        sink, base, air = self.island(kept)
        two = self.started("mote", "--id", "2", "--radio", air, "--app", "-", "--seed", "2")
        two.call("join", type=1, transducers=3, actuators=1)
        two.event("joined", own="11:2", success=True)
        three = self.started("mote", "--id", "3", "--radio", air, "--seed", "3")
        three.event("joined", own="11:3", success=True)
        for mote in ("11:2", "11:3"):
            sink.event("mote_joined", mote=mote)
            base.event("received", src=mote)
        two.call("send", dest="11:3", app_id=10, reliable=True, data="0102")
        number = two.event("send_result", success=True)["seq_num"]
        three.event("received", src="11:2", app_id=10, data="0102")
        two.event("ack_received", seq_num=number, success=True)
        base.call("send", dest="11:2", app_id=10, reliable=True, data="0a")
        number = base.event("send_result", success=True)["seq_num"]
        two.event("received", app_id=10, data="0a")
        base.event("ack_received", seq_num=number, success=True)
        two.call("send", dest="11:65533", app_id=10, reliable=False, data="0b")
        base.event("received", src="11:2", data="0b")
        for node in (two, three, base, sink):
            self.assertEqual(node.end()[0], 0)
        messages = [record["message"] for record in lines_of(kept)]
        for wanted in ("join_request", "join_reply", "ack_join", "mac_ack", "config"):
            self.assertIn(wanted, messages)
        checked = subprocess.run([RUBRIC, "check", kept], capture_output=True, check=False,
                                 text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout)
        self.assertIn("mote 3", checked.stdout)

    def test_a_base_station_comes_back_to_its_sink(self):
        place = socket.create_server(("127.0.0.1", 0))
        port = place.getsockname()[1]
        base = self.started("base-station", "--island", "12", "--sink", f"sf@127.0.0.1:{port}")
        for _ in range(2):
            place.settimeout(PATIENCE_S)
            connection, _ = place.accept()
            self.assertEqual(connection.recv(2), b"U ")
            connection.sendall(b"U ")
            base.waits_for(rb"(connected)")
            # SET_ISLAND_ID, at each coming.
            self.assertTrue(connection.recv(64))
            connection.close()
            base.waits_for(rb"(closed it|broke)")
        place.close()
        self.assertEqual(base.end()[0], 0)

    def test_clear_errors(self):
        for arguments, text in (
                (("mote",), "--id: a mote needs one"),
                (("mote", "--id", "1"), "from 2 to 65532"),
                (("mote", "--id", "2", "--island", "11"), "by joining"),
                (("sink",), "--island: is needed by a sink"),
                (("sink", "--island", "65535"), "--island"),
                (("mote", "--id", "2", "--radio", "sf@x:1"), "expected zep:PORT"),
                (("sink", "--island", "11", "--serial", "9002"), "expected sf-server:PORT")):
            run = subprocess.run([RUBRIC, "run", *arguments], capture_output=True, check=False,
                                 text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(run.returncode, 64, run.stderr)
            self.assertIn(text, run.stderr)
        taken = socket.create_server(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        run = subprocess.run([RUBRIC, "run", "sink", "--island", "11", "--radio", "zep:0",
                              "--serial", f"sf-server:{port}"], capture_output=True, check=False,
                             text=True)
        taken.close()
        self.assertEqual(run.returncode, 66)
        self.assertIn(f"port {port}: Address already in use", run.stderr)

    def test_two_motes_of_one_id_and_a_wrong_call(self):
        one = self.started("mote", "--id", "5", "--radio", "zep:0", "--app", "-")
        air = "zep:" + one.waits_for(rb"zep:(\d+)\n")
        self.started("mote", "--id", "5", "--radio", air)
        self.assertEqual(one.waits_for(rb"has the id (\d+), too"), "5")
        for call in (b"{\n", b"[]\n", b'{"call":"fly"}\n', b'{"call":"start","channel":"2"}\n',
                     b'{"call":"send","dest":"11:70000","app_id":10,"reliable":true,"data":"0"}\n'):
            one.process.stdin.write(call)
            one.process.stdin.flush()
            self.assertEqual(one.lines(1)[0]["event"], "error")
        one.process.stdin.close()
        self.assertEqual(one.end(None)[0], 0)


if __name__ == "__main__":
    unittest.main()
