#!/usr/bin/env python3
"""`rubric send` on serial lines: bytes on the wire, output, and results of packets.

Usage: send_test.py RUBRIC. The other ends are motes of this test's, on pseudo
terminals and sockets.
"""

import json
import os
import signal
import socket
import struct
import subprocess
import threading
import time
import unittest

from live_testing import Mote, lines_of
from send_testing import (CLEAN, LONG_MS, NOT_SENT, OUTPUT, Base, config, confirms, line,
                          send)
from serial_testing import ACK, PACKET_ACK, PACKET_NOACK, PATIENCE_S, Pty, hdlc, wait_for
from testing import rubric

DEMO = "spec/captures/basestation/s04_acks.from_sink.sfstream"


class Serial(Base):
    def test_a_packet_is_confirmed(self):
        to, mote = self.mote(confirms)
        packet = struct.pack(">BHHBBBBH", 0, 7, 3, 3, 0x7d, 37, 10, 0x7e7d)
        code, out, err = send("--as", "config", "--to", to, "--dest", "7", "--src", "3", "--group",
                              "125", "--timeout", LONG_MS, text=line(0x7e7d))
        self.assertEqual(code, CLEAN, err)
        self.assertRegex(out, r"^   1  config          confirmed after 1 try, \d+ ms\n$")
        self.assertEqual(err, "rubric: 1 packet, 1 confirmed\n")
        mote.end()
        self.assertEqual(mote.bytes, hdlc(bytes([PACKET_ACK, 14]) + packet))
        self.assertIn(b"\x7d\x5e\x7d\x5d", mote.bytes)

    def test_one_after_the_other(self):
        to, mote = self.mote(confirms)
        text = "".join(line(value) for value in range(300))
        code, out, err = send("--as", "config", "--to", to, "--timeout", LONG_MS, text=text)
        self.assertEqual(code, CLEAN, err)
        self.assertEqual(out.count(" confirmed after 1 try"), 300)
        mote.end()
        self.assertEqual(mote.packets, [((14 + i) % 256, config(i)) for i in range(300)])

    def test_not_confirmed(self):
        for more, wanted in (((), [(14, 1), (15, 1), (16, 1)]),
                             (("--keep-going",), [(14 + i, 1 + i // 3) for i in range(6)])):
            to, mote = self.mote(lambda *_: None)
            code, out, err = send("--as", "config", "--to", to, "--timeout", "30", "--retries",
                                  "2", *more, text=line(1) + line(2))
            self.assertEqual(code, NOT_SENT, err)
            self.assertRegex(out, r"^   1  config          not confirmed after 3 tries, \d+ ms\n")
            if more:
                self.assertEqual(out.count("not confirmed after 3 tries"), 2)
                self.assertEqual(err, "rubric: 2 packets, 0 confirmed, 2 not\n")
            else:
                self.assertEqual(out.count("\n"), 1)
                self.assertEqual(err, "rubric: stdin:1: not confirmed; nothing after it is sent "
                                      "(--keep-going would)\n"
                                      "rubric: 1 packet, 0 confirmed, 1 not\n")
            mote.end()
            self.assertEqual(mote.packets, [(seq, config(value)) for seq, value in wanted])

    def test_a_wrong_number_confirms_nothing(self):
        to, _ = self.mote(lambda _, seq, __: hdlc(bytes([ACK, seq + 1])))
        code, out, err = send("--as", "config", "--to", to, "--timeout", "200", "--retries", "0",
                              text=line(1))
        self.assertEqual(code, NOT_SENT, err)
        self.assertRegex(out, r"not confirmed after 1 try, \d+ ms; 1 confirmation of other numbers "
                              r"came\n$")

    def test_a_mote_that_disappears(self):
        device = Pty(self)

        def answer(mote, seq, _):
            if len(mote.packets) == 1:
                return hdlc(bytes([ACK, seq]))
            device.close()
            raise OSError

        Mote(self, device.fd, answer)
        to = f"serial@{device.name}:telosb"
        code, out, err = send("--as", "config", "--to", to, "--timeout", LONG_MS,
                              "--keep-going", text=line(1) + line(2) + line(3))
        self.assertEqual(code, NOT_SENT)
        self.assertRegex(out, r"^   1 .* confirmed after 1 try, .*\n   2 .* not confirmed after 1 "
                              r"try, \d+ ms\n$")
        self.assertIn(f"rubric: {to}: the line broke: ", err)
        self.assertIn("rubric: 2 packets, 1 confirmed, 1 not\n", err)

    def test_through_tcp(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            listener.settimeout(PATIENCE_S)
            to = f"network@127.0.0.1:{listener.getsockname()[1]}"
            running = self.started("send", "--as", "config", "--to", to, "--timeout", LONG_MS,
                                   stdin=subprocess.PIPE)
            connection, _ = listener.accept()
        self.addCleanup(connection.close)
        mote = Mote(self, connection.fileno(), confirms)
        running.process.stdin.write(line(5).encode())
        running.process.stdin.flush()
        self.assertIn(" confirmed after 1 try", running.text_lines(1)[0])
        mote.end()
        self.assertEqual(mote.packets, [(14, config(5))])
        connection.close()
        code, _, err = running.end(None)
        self.assertEqual(code, NOT_SENT)
        self.assertIn(f"rubric: {to}: the line broke: the other end closed it\n", err)

    def test_what_is_answered_is_shown(self):
        heard = threading.Event()

        def answer(mote, seq, _):
            def later():
                heard.wait(PATIENCE_S)
                os.write(mote.fd, hdlc(bytes([PACKET_NOACK]) + config(77)))

            threading.Thread(target=later, daemon=True).start()
            return hdlc(bytes([ACK, seq]))

        to, _ = self.mote(answer)
        running = self.started("send", "--as", "config", "--to", to, "--timeout", LONG_MS,
                               "--listen", "600", stdin=subprocess.PIPE)
        running.process.stdin.write(line(5).encode())
        running.process.stdin.close()
        self.assertIn("confirmed after 1 try", running.text_lines(1)[0])
        heard.set()
        self.assertRegex(running.text_lines(1)[0], r"-> .*config +.*77")
        code, out, err = running.end()
        self.assertEqual((code, out), (CLEAN, ""), err)
        self.assertEqual(err, "rubric: 1 packet, 1 confirmed, 1 came\n")

    def test_what_is_answered_as_json(self):
        def answer(_, seq, packet):
            return hdlc(bytes([PACKET_NOACK]) + packet) + hdlc(bytes([ACK, seq]))

        to, _ = self.mote(answer)
        code, out, err = send("--as", "config", "--to", to, "--timeout", LONG_MS, "--listen", "0",
                              "--format", "jsonl", text=line(5) + line(6))
        self.assertEqual(code, CLEAN, err)
        records = [json.loads(row) for row in out.splitlines()]
        self.assertEqual([row["fields"]["value"] for row in records], [5, 6])
        self.assertEqual([row["index"] for row in records], [0, 1])
        self.assertEqual({row["direction"] for row in records}, {"outbound"})
        self.assertEqual({row["interface"] for row in records}, {to})
        self.assertEqual(err.count("confirmed after 1 try"), 2)

    def test_nobody_reads_any_more(self):
        """All is sent, and nothing is listened to for nobody."""
        def answer(mote, seq, packet):
            reply = hdlc(bytes([ACK, seq]))
            if packet == config(9):  # Again and again, until somebody has enough.
                threading.Thread(target=chatter, args=(mote,), daemon=True).start()
            return reply

        def chatter(mote):
            while mote.fd >= 0 and not done.wait(0.05):
                os.write(mote.fd, hdlc(bytes([PACKET_NOACK]) + config(77)))

        done = threading.Event()
        self.addCleanup(done.set)
        to, mote = self.mote(answer)
        running = self.started("send", "--as", "config", "--to", to, "--timeout", LONG_MS,
                               "--listen", "600", stdin=subprocess.PIPE)
        running.process.stdout.close()
        running.process.stdin.write("".join(line(value) for value in range(10)).encode())
        running.process.stdin.close()
        self.assertEqual(running.process.wait(PATIENCE_S), OUTPUT)
        done.set()
        mote.end()
        self.assertEqual(len(mote.packets), 10)

    def test_lines_are_sent_as_they_come(self):
        to, mote = self.mote(confirms)
        running = self.started("send", "--as", "config", "--to", to, "--timeout", LONG_MS,
                               stdin=subprocess.PIPE)
        for value in range(3):
            running.process.stdin.write(b"\n" + line(value).encode())
            running.process.stdin.flush()
            self.assertIn(" confirmed after 1 try", running.text_lines(1)[0])
        time.sleep(0.2)
        self.assertIsNone(running.process.poll())
        code, _, err = running.end()
        self.assertEqual((code, err), (CLEAN, "rubric: 3 packets, 3 confirmed\n"))
        mote.end()
        self.assertEqual(len(mote.packets), 3)

    def test_interrupted(self):
        to, mote = self.mote(lambda *_: None)
        running = self.started("send", "--as", "config", "--to", to, "--timeout", LONG_MS,
                               "--keep-going", stdin=subprocess.PIPE)
        running.process.stdin.write((line(1) + line(2)).encode())
        running.process.stdin.close()
        wait_for(lambda: mote.packets, "a packet comes")
        code, out, err = running.end(signal.SIGTERM)
        self.assertEqual(code, NOT_SENT)
        self.assertIn("not confirmed after 1 try", out)
        self.assertEqual(err, "rubric: stdin:1: stopped; nothing after it is sent\n"
                              "rubric: 1 packet, 0 confirmed, 1 not\n")
        mote.end()
        self.assertEqual(mote.packets, [(14, config(1))])

    def test_between_packets_is_waited(self):
        to, mote = self.mote(confirms)
        begun = time.monotonic()
        code, _, err = send("--as", "config", "--to", to, "--timeout", LONG_MS, "--interval", "200",
                            text=line(1) * 4)
        self.assertEqual(code, CLEAN, err)
        self.assertGreaterEqual(time.monotonic() - begun, 0.6)
        mote.end()
        self.assertEqual(len(mote.packets), 4)

    def test_what_was_decoded_is_sent_again(self):
        """Sends a capture of both directions, whose confirmations are no packets."""
        to, mote = self.mote(confirms)
        rows = lines_of(DEMO)[:20]
        ack = json.loads(rubric("decode", "--format", "jsonl", "--input-format", "hdlc",
                                stdin=hdlc(b"\x43\x05"))[1])
        path = self.write("run.jsonl", "".join(json.dumps(row) + "\n" for row in [ack, *rows, ack]))
        code, out, err = send(path, "--to", to, "--timeout", LONG_MS)
        self.assertEqual(code, CLEAN, err)
        self.assertEqual(err, f"rubric: {len(rows)} packets, {len(rows)} confirmed, 2 frames "
                              "without a packet left out\n")
        self.assertEqual([row.split()[1] for row in out.splitlines()],
                         [row["message"] for row in rows])
        mote.end()
        self.assertEqual([packet.hex() for _, packet in mote.packets], [row["raw"] for row in rows])


if __name__ == "__main__":
    unittest.main()
