#!/usr/bin/env python3
"""`rubric run proxy`: one access point over motes behind a sink and a network of lines.

Usage: proxy_test.py RUBRIC. All of it on this host's loopback.
"""

import json
import select
import socket
import subprocess
import sys
import unittest

from live_testing import Flood, LiveTest
from run_test import Node
from serial_testing import PATIENCE_S
from testing import ROOT

HOME = ROOT / "conformance/node/examples/home_lines.py"
MASKS = {"light": 1, "temp": 2}


class Lines:
    """Lines of a pipe or a socket, waited for with patience."""

    def __init__(self, source):
        self.source = source
        self.rest = b""

    def next(self):
        while b"\n" not in self.rest:
            if not select.select([self.source], [], [], PATIENCE_S)[0]:
                raise AssertionError(f"nothing more after {self.rest}")
            more = self.read()
            if not more:
                raise AssertionError(f"it ended with {self.rest}")
            self.rest += more
        line, self.rest = self.rest.split(b"\n", 1)
        return line.decode()


class Piped(Lines):
    def read(self):
        return self.source.read1(4096)


class Client(Lines):
    """A program that uses the proxy."""

    def __init__(self, test, port):
        super().__init__(socket.create_connection(("127.0.0.1", port)))
        test.addCleanup(self.source.close)

    def read(self):
        return self.source.recv(4096)

    def say(self, **what):
        self.source.sendall(json.dumps(what).encode() + b"\n")

    def event(self, event, **fields):
        while True:
            found = json.loads(self.next())
            if found["event"] == event and fields.items() <= found.items():
                return found
            if found["event"] == "error":
                raise AssertionError(found)


class Mote(Node):
    """A mote whose application is this test."""

    def is_asked(self, times):
        """It was asked so often whether it is there, by a message without data."""
        for _ in range(times):
            self.event("received", data="")

    def told(self):
        """The data of the next message that has any."""
        while not (data := self.event("received")["data"]):
            pass
        return bytes.fromhex(data)

    def sampling(self):
        """The period and the sensors that the next read_updates asks for."""
        data = self.told()
        if len(data) != 5 or data[0] != 36:
            raise AssertionError(data)
        mask = int.from_bytes(data[3:], "big")
        return int.from_bytes(data[1:3], "big"), {name for name, bit in MASKS.items() if mask & bit}

    def joins(self, transducers):
        self.call("join", type=1, transducers=transducers, actuators=2)
        if not self.event("joined")["success"]:
            raise AssertionError("not joined")


class ProxyTest(LiveTest):
    program = Mote
    forgetting = ("--gone-after", "1")  # Of the sink.

    def setUp(self):
        super().setUp()
        self.home = subprocess.Popen([sys.executable, HOME], stdin=subprocess.PIPE,
                                     stdout=subprocess.PIPE)
        self.addCleanup(self.home.stdout.close)
        self.addCleanup(self.home.wait)
        self.addCleanup(self.home.kill)
        self.addCleanup(self.home.stdin.close)
        self.asked = Piped(self.home.stdout)
        lines = self.asked.next()
        self.sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial",
                                 "sf-server:0", *self.forgetting)
        self.air = self.sink.waits_for(rb"(zep:\d+)\n")
        port = self.sink.waits_for(rb"sf-server:(\d+)\n")
        self.arguments = ("proxy", "--island", "11", "--sink", f"sf@localhost:{port}",
                          "--gone-after", "1", "--network", f"lines:127.0.0.1:{lines}")
        self.begin()

    def begin(self):
        self.proxy = self.started(*self.arguments)
        # A sink reports a new mote once, so its line must have a reader by then.
        self.port = int(self.proxy.waits_for(
            rb"proxy at 127.0.0.1:(\d+)\n(?s:.*)sf@\S+: connected"))

    def mote(self):
        mote = self.started("mote", "--id", "5", "--radio", self.air, "--app", "-")
        mote.joins(3)
        return mote


class Proxy(ProxyTest):
    def test_subscriptions_configure_a_mote(self):
        one, two = Client(self, self.port), Client(self, self.port)
        # A device that is not there yet is read when it comes.
        one.say(subscribe="11:5", sensors=["light"], period_ms=500)
        one.event("awaited", device="11:5")
        one.say(subscribe="1/1/8", period_ms=10_000)
        self.assertEqual(self.asked.next(), "watch 1/1/8 10000 state")
        mote = self.mote()
        self.assertEqual(one.event("device", device="11:5"),
                         {"event": "device", "network": "motes", "device": "11:5",
                          "sensors": ["light", "temp"], "actuators": ["open"]})
        self.assertEqual(mote.sampling(), (500, {"light"}))
        # The most eager one decides, and all sensors are read that anybody wants.
        two.say(subscribe="11:5", sensors=["temp"], period_ms=200)
        self.assertEqual(mote.sampling(), (200, {"light", "temp"}))
        # updates: light 512, temp 6150.
        mote.call("send", dest="11:65533", app_id=10, reliable=False,
                  data="2302000102000002" + "1806")
        for client in (one, two):
            self.assertEqual(client.event("reading", device="11:5")["data"],
                             {"light": {"raw": 512},
                              "temp": {"raw": 6150, "value": 21.5, "unit": "degC"}})
        # Whoever leaves, by a word or without, wants nothing more; the last one ends the readings.
        two.say(unsubscribe="11:5")
        self.assertEqual(mote.sampling(), (500, {"light"}))
        one.source.close()
        self.assertEqual(mote.sampling()[0], 0)
        self.assertEqual(self.asked.next(), "watch 1/1/8 0")
        two.say(command="OPEN_DOOR", device="11:5")
        self.assertEqual(mote.told(), b"OPEN_DOOR")
        self.assertEqual(two.event("command"), {"event": "command", "device": "11:5",
                                                "command": "OPEN_DOOR", "outcome": "done"})
        # A mote that went and came again is told anew.
        two.say(subscribe="11:5", sensors=["light"], period_ms=300)
        self.assertEqual(mote.sampling(), (300, {"light"}))
        mote.process.kill()
        two.event("left", device="11:5")
        self.assertEqual(self.mote().sampling(), (300, {"light"}))
        for node in (self.proxy, self.sink):
            self.assertEqual(node.end()[0], 0)

    def test_lines_are_a_network_like_any_other(self):
        client = Client(self, self.port)
        client.event("device", network="lines", device="1/1/7")
        client.event("device", device="1/1/8")
        client.say(subscribe="1/1/8", period_ms=20)
        self.assertEqual(client.event("reading", device="1/1/8")["data"], {"state": {"value": 0.0}})
        client.say(command="on", device="1/1/8")
        client.event("command", command="on", outcome="sent")
        for device, command, why in (("1/1/5", "on", "no such device"),
                                     ("1/1/8", "ON !", "expected a word")):
            client.say(command=command, device=device)
            self.assertIn(why, client.event("command", device=device, outcome="refused")["text"])
        while client.event("reading", device="1/1/8")["data"] != {"state": {"value": 1.0}}:
            pass
        self.home.stdin.write(b"there 1/1/9 switch\nvalue 1/1/9 switch nan\ngone 1/1/7\n")
        self.home.stdin.flush()
        client.event("device", device="1/1/9")
        self.proxy.waits_for(rb"(refused 'value 1/1/9 switch nan')")
        client.event("left", device="1/1/7")
        # What makes no sense is an error for who said it, and for nobody else.
        other = Client(self, self.port)
        for wrong in ("{", "[]", '{"subscribe":5}', '{"subscribe":"1/1/8","period_ms":0}', "{}",
                      '{"subscribe":"1/1/8","sensors":["humid"]}', "x" * 5000,
                      '{"command":"on"}'):
            other.source.sendall(wrong.encode() + b"\n")
            while (event := json.loads(other.next()))["event"] != "error":
                self.assertEqual(event["event"], "device")
        # The network is gone with its devices.
        self.home.kill()
        for device in ("1/1/8", "1/1/9"):
            client.event("left", device=device)
        self.assertEqual(self.proxy.end()[0], 0)

    def test_a_flood_does_not_hold_it(self):
        device = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(device.close)
        proxy = self.started(*self.arguments[:-1], f"lines:127.0.0.1:{device.getsockname()[1]}")
        port = int(proxy.waits_for(rb"proxy at 127.0.0.1:(\d+)\n"))
        device.settimeout(PATIENCE_S)
        line, _ = device.accept()
        self.addCleanup(line.close)
        client = Client(self, port)
        line.sendall(b"x" * 3000 + b" there a/b light\nthere c/d light\n")
        self.assertEqual(json.loads(client.next())["device"], "c/d")
        Flood(line, b"x y\n")
        Flood(client.source, b'{"unsubscribe":"x"}\n')
        # Others are heard meanwhile.
        Client(self, port).event("device", device="c/d")
        code, _, err = proxy.end()
        self.assertEqual(code, 0, err)
        self.assertIn("refused a line of more than 2048 bytes", err)
        self.assertRegex(err, r"refused \d+ more")


class Alive(ProxyTest):
    """Motes that are there though the proxy has not heard of them for a while."""

    forgetting = ()

    def quiet(self, client):
        """A mote that was told to be silent, and was, for more than the time of --gone-after."""
        client.say(subscribe="11:5", sensors=["light"], period_ms=500)
        mote = self.mote()
        self.assertEqual(mote.sampling(), (500, {"light"}))
        client.say(unsubscribe="11:5")
        self.assertEqual(mote.sampling()[0], 0)
        client.event("device", device="11:5")
        mote.is_asked(3)  # After half of it each.
        client.say(subscribe="11:5", sensors=["temp"], period_ms=300)
        return mote

    def updates(self, mote):
        mote.call("send", dest="11:65533", app_id=10, reliable=False, data="2301000102" + "00")

    def test_a_silenced_mote_is_there(self):
        client = Client(self, self.port)
        mote = self.quiet(client)
        self.assertEqual(mote.sampling(), (300, {"temp"}))
        self.updates(mote)
        self.assertEqual(json.loads(client.next())["event"], "reading")

    def test_a_mote_that_nobody_asks_for_readings_is_there(self):
        client = Client(self, self.port)
        mote = self.mote()
        mote.is_asked(3)
        client.say(command="OPEN_DOOR", device="11:5")
        self.assertEqual(mote.told(), b"OPEN_DOOR")
        self.assertEqual(client.event("command")["outcome"], "done")

    def test_a_command_without_an_answer(self):
        client = Client(self, self.port)
        self.quiet(client).process.kill()
        client.say(command="OPEN_DOOR", device="11:5")
        client.event("command", command="OPEN_DOOR", outcome="no answer")

    def test_a_silenced_mote_that_has_gone(self):
        client = Client(self, self.port)
        self.quiet(client).process.kill()
        client.event("left", device="11:5")

    def test_a_mote_is_heard_again(self):
        client = Client(self, self.port)
        mote = self.mote()
        mote.call("interface", link="radio", on=False)
        client.event("left", device="11:5")
        mote.call("interface", link="radio", on=True)
        client.say(subscribe="11:5", sensors=["temp"], period_ms=300)
        self.updates(mote)
        self.assertEqual(client.event("device", device="11:5")["sensors"], ["light", "temp"])
        client.event("reading", device="11:5")
        self.assertEqual(mote.sampling(), (300, {"temp"}))

    def test_a_mote_that_joined_before(self):
        mote = self.mote()
        self.proxy.event("received")
        self.assertEqual(self.proxy.end()[0], 0)
        self.begin()
        client = Client(self, self.port)
        client.say(subscribe="11:5", period_ms=300)
        self.updates(mote)
        device = client.event("device", device="11:5")
        self.assertEqual((device["sensors"], device["actuators"]), (["light"], []))
        self.assertEqual(client.event("reading")["data"], {"light": {"raw": 512}})
        self.assertEqual(mote.sampling(), (300, {"light"}))


if __name__ == "__main__":
    unittest.main()
