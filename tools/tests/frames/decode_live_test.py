#!/usr/bin/env python3
"""`rubric decode` on lines in use: pseudo terminals, a serial forwarder's port, a growing file.

Usage: decode_live_test.py RUBRIC. All of it on this host, bounded in time.
"""

import os
import pty
import signal
import socket
import time
import unittest

from live_testing import Forwarder, LiveTest, lines_of
from serial_testing import PATIENCE_S, Pty, hdlc
from testing import ROOT

SERIAL = "spec/captures/firmware/a_join_data.serial.bin"
FORWARDER = "spec/captures/basestation/s04_acks.from_sink.sfstream"


def meaning(records):
    return [(record["message"], record["fields"], record["error"]) for record in records]


class Live(LiveTest):
    def test_a_serial_line(self):
        line = Pty(self)
        kept = self.folder / "kept.pcapng"
        running = self.started("decode", f"serial@{line.name}:telosb", "--format", "jsonl",
                               "--write", kept)
        wanted = lines_of(SERIAL)
        line.opened(running.process)
        os.write(line.fd, (ROOT / SERIAL).read_bytes()[:2000])
        records = running.lines(10)
        self.assertEqual(meaning(records), meaning(wanted[:10]))
        self.assertEqual({record["interface"] for record in records},
                         {f"serial@{line.name}:telosb"})
        self.assertLess(abs(records[-1]["time"] - time.time()), PATIENCE_S)
        code, _, err = running.end()
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"^rubric: \d+ frames, 0 malformed, \d+ shown\n$")
        self.assertEqual(meaning(lines_of(kept))[:10], meaning(wanted[:10]))

    def test_frames_that_ask_for_it_are_confirmed(self):
        packet = bytes.fromhex("00ffff000003002514000c")
        for arguments, answer in (((), hdlc(b"\x43\x2a")), (("--listen-only",), b"")):
            line = Pty(self)
            running = self.started("decode", f"serial@{line.name}:115200", "--format", "jsonl",
                                   *arguments)
            line.opened(running.process)
            os.write(line.fd, hdlc(b"\x44\x2a" + packet))
            self.assertEqual(running.lines(1)[0]["message"], "config")
            self.assertEqual(line.read(0.5), answer)
            self.assertEqual(running.end()[0], 0)

    def test_what_came_is_delivered_though_no_answer_can_be_sent(self):
        count = 2000
        frame = hdlc(b"\x44\x2a" + bytes.fromhex("00ffff000003002514000c"))
        listener = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(listener.close)
        running = self.started("decode", f"network@127.0.0.1:{listener.getsockname()[1]}",
                               "--format", "jsonl")
        connection, _ = listener.accept()
        connection.sendall(frame * count)
        connection.close()
        self.assertEqual(len(running.lines(count)), count)
        code, _, err = running.end(None)
        self.assertEqual(code, 66)
        self.assertIn("the line broke", err)

    def test_a_file_that_is_overwritten(self):
        path = self.folder / "growing.bin"
        whole = (ROOT / SERIAL).read_bytes()
        for other in (whole[500:], whole[500:1500]):  # Larger, and of the same size.
            path.write_bytes(whole[:1000])
            running = self.started("decode", "--follow", path, "--format", "jsonl")
            shown = len(running.lines(2))
            self.assertEqual(shown, 2)
            with open(path, "r+b") as file:
                file.write(other)
            code, _, err = running.end(None)
            self.assertEqual(code, 66)
            self.assertIn("it was overwritten", err)

    def test_a_serial_forwarder_that_goes(self):
        server = Forwarder(self)
        running = self.started("decode", f"sf@127.0.0.1:{server.port}", "--format", "jsonl")
        connection = server.accept((ROOT / FORWARDER).read_bytes())
        wanted = lines_of(FORWARDER)
        self.assertEqual(meaning(running.lines(len(wanted))), meaning(wanted))
        connection.close()
        code, _, err = running.end(None)
        self.assertEqual(code, 66)
        self.assertIn(f"sf@127.0.0.1:{server.port}: the line broke: the other end closed it", err)

    def test_a_serial_forwarder_that_comes_back(self):
        server = Forwarder(self)
        running = self.started("decode", f"sf@127.0.0.1:{server.port}", "--format", "jsonl",
                               "--reconnect")
        wanted = lines_of(FORWARDER)
        for _ in range(2):
            connection = server.accept((ROOT / FORWARDER).read_bytes())
            self.assertEqual(meaning(running.lines(len(wanted))), meaning(wanted))
            connection.close()
        connection = server.accept((ROOT / FORWARDER).read_bytes())
        running.lines(len(wanted))
        code, _, err = running.end(signal.SIGTERM)
        connection.close()
        self.assertEqual(code, 0, err)
        self.assertEqual(err.count("the other end closed it"), 2)
        self.assertEqual(err.count("again"), 2)
        self.assertIn(f"rubric: {3 * len(wanted)} frames", err)

    def test_what_another_source_could_not_do_is_not_forgotten(self):
        server = Forwarder(self)
        wanted = lines_of(FORWARDER)
        running = self.started("decode", "sf@127.0.0.1:1", f"sf@127.0.0.1:{server.port}",
                               "--format", "jsonl")
        connection = server.accept((ROOT / FORWARDER).read_bytes())
        running.lines(len(wanted))
        code, _, err = running.end()
        connection.close()
        self.assertEqual((code, err.count("cannot connect"), err.count("again")), (66, 1, 0))

    def test_a_file_that_grows(self):
        path = self.folder / "growing.pcapng"
        whole = (ROOT / "spec/captures/firmware/a_join_data.pcapng").read_bytes()
        wanted = lines_of("spec/captures/firmware/a_join_data.pcapng")
        path.write_bytes(b"")
        running = self.started("decode", path, "--follow", "--format", "jsonl")
        found = []
        with open(path, "ab", buffering=0) as file:
            for at in range(0, len(whole), 3001):
                file.write(whole[at:at + 3001])
                time.sleep(0.02)
        found = running.lines(len(wanted))
        self.assertEqual(found, wanted)
        path.write_bytes(whole[:100])
        code, _, err = running.end(None)
        self.assertEqual(code, 66)
        self.assertIn("it has become shorter", err)

    def test_motecom(self):
        server = Forwarder(self)
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        running = self.started("decode", "--format", "jsonl", "--count", "1", stdin=slave,
                               env={**os.environ, "MOTECOM": f"sf@127.0.0.1:{server.port}"})
        os.close(slave)
        server.accept((ROOT / FORWARDER).read_bytes())
        self.assertEqual(len(running.lines(1)), 1)
        self.assertEqual(running.end(None)[0], 0)

    def test_lines_that_cannot_be(self):
        for name, what in (("serial@/dev/ttyUSB0", "expected serial@DEVICE:BAUD"),
                           ("serial@/dev/null:fast", "expected serial@DEVICE:BAUD"),
                           ("sf@nowhere", "expected HOST:PORT")):
            self.refused(("decode", name), what)
        for name, what in (("serial@/dev/null:115200", "is not a serial line"),
                           ("serial@/no/such:57600", "cannot be opened"),
                           ("sf@127.0.0.1:1", "cannot connect")):
            self.refused(("decode", name), what, 66)


if __name__ == "__main__":
    unittest.main()
