#!/usr/bin/env python3
"""The Java base station as a client of `rubric forward`, twice at once, beside one in Python.

Usage: forward_java_test.py RUBRIC JAVA CLASSES
"""

import subprocess
import sys
import unittest

from forward_testing import Client, from_mote, serving
from serial_testing import PATIENCE_S

COMMAND = [sys.argv[1], "-cp", sys.argv[2], "rubric.basestation.ForwarderClient"]
ISLAND = 11
ISLAND_TO_SINK = bytes.fromhex("0000010000030025") + bytes([10, 0, ISLAND])
# From mote 5 to the island's base station, to be confirmed: application 10, "OPEN".
RELIABLE = bytes.fromhex("00ffff000072001c" "000bfffd000b0005010028" "0603" "0a4f50454e").ljust(
    122, b"\xee")


class Java(unittest.TestCase):
    def station(self, running):
        process = subprocess.Popen([*COMMAND, f"{running.host}:{running.port}", str(ISLAND)],
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

        def end():
            process.kill()
            process.communicate()
        self.addCleanup(end)
        return process

    def test_two_base_stations_and_a_listener(self):
        mote, running = serving(self, "--verbose", "--timeout", str(1000 * PATIENCE_S))
        listener = Client(self, running)
        stations = []
        for _ in range(2):
            stations.append(self.station(running))
            self.assertEqual(mote.confirmed_packet(), ISLAND_TO_SINK)
            self.assertEqual(stations[-1].stdout.readline(), "op_result(success)\n")
        mote.say(from_mote(RELIABLE))
        self.assertEqual(listener.packet(), RELIABLE)
        for station in stations:
            self.assertEqual(station.stdout.readline(), "received(11:5 10 x4f50454e)\n")
            ack = mote.confirmed_packet()
            self.assertEqual(len(ack), 122)
            self.assertEqual(ack[8:17], bytes.fromhex("000b0005000bfffd00"))
        stations[0].kill()
        running.wait_for("has left")
        mote.say(from_mote(RELIABLE[:17] + b"\x00\x29" + RELIABLE[19:]))
        self.assertEqual(stations[1].stdout.readline(), "received(11:5 10 x4f50454e)\n")
        mote.confirmed_packet()
        mote.say(from_mote(RELIABLE[:8]))  # Behind the confirmation, which is then heard, too.
        for data in (RELIABLE[:17] + b"\x00\x29" + RELIABLE[19:], RELIABLE[:8]):
            self.assertEqual(listener.packet(), data)
        code, summary = running.end()
        self.assertEqual(code, 0)
        self.assertRegex(summary, ": 3 packets from it .*, 5 to it; 3 clients, 0 cut off$")


if __name__ == "__main__":
    del sys.argv[1:3]
    unittest.main()
