#!/usr/bin/env python3
"""The Java base station as a client of a serial forwarder, which this test plays.

Usage: forwarder_test.py JAVA CLASSES
"""

import socket
import subprocess
import sys
import time
import unittest

COMMAND = []
TICK_S = 1 / 1024


def packet(kind, payload, dest=0xFFFF):
    header = bytes([0]) + dest.to_bytes(2, "big") + bytes([0, 0, len(payload), 0, kind])
    return header + payload


def net_msg(src, trans_id, app_id, data, reliable=0, number=7):
    body = bytes([trans_id, app_id]) + data
    head = bytes.fromhex("000bfffd") + src + bytes([reliable]) + number.to_bytes(2, "big")
    return packet(28, (head + bytes([len(body)]) + body).ljust(114, b"\xee"))


class Forwarder:
    """Listens, starts the base station of island 11, and shakes hands as given."""

    def __init__(self, hello=b"U "):
        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(30)
            host, port = server.getsockname()
            self.station = subprocess.Popen([*COMMAND, f"{host}:{port}", "11"], text=True,
                                            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=subprocess.PIPE)
            self.line, _ = server.accept()
        self.line.settimeout(30)
        self.hello = self.take(2)
        self.line.sendall(hello)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.line.close()
        self.station.kill()
        self.station.communicate()

    def take(self, size):
        out = b""
        while len(out) < size:
            more = self.line.recv(size - len(out))
            if not more:
                raise EOFError
            out += more
        return out

    def packet(self):
        return self.take(self.take(1)[0])

    def give(self, data):
        self.line.sendall(bytes([len(data)]) + data)

    def call(self, text):
        self.station.stdin.write(text + "\n")
        self.station.stdin.flush()

    def news(self):
        return self.station.stdout.readline().strip()

    def end(self):
        """Returns exit code and complaints of the station at its end after the connection."""
        self.line.close()
        _, complaints = self.station.communicate(timeout=30)
        return self.station.returncode, complaints


class ForwarderClientTest(unittest.TestCase):
    def test_tells_its_sink_the_island_at_first(self):
        with Forwarder() as sink:
            self.assertEqual(sink.hello, b"U ")
            self.assertEqual(sink.packet(), packet(37, bytes([10, 0, 11]), dest=1))
            self.assertEqual(sink.news(), "op_result(success)")
            self.assertEqual(sink.end(), (0, ""))

    def test_delivers_and_acks(self):
        with Forwarder() as sink:
            sink.packet(), sink.news()
            sink.give(net_msg(bytes.fromhex("000b0005"), 3, 10, b"OPEN", reliable=1, number=40))
            self.assertEqual(sink.news(), "received(11:5 10 x4f50454e)")
            ack = sink.packet()
            self.assertEqual(len(ack), 8 + 114)
            self.assertEqual(ack[:8], bytes.fromhex("000001000072001c"))
            self.assertEqual(ack[8:17], bytes.fromhex("000b0005000bfffd00"))
            self.assertEqual(ack[19:26], bytes.fromhex("06090a17002800"))

    def test_a_message_in_pieces_and_what_is_no_message(self):
        with Forwarder() as sink:
            sink.packet(), sink.news()
            sink.give(bytes([1, 2, 3]))  # Not an active message.
            sink.line.sendall(b"\0")  # A length that cannot be.
            sink.give(packet(28, bytes(5)))  # Cut within its header.
            whole = net_msg(bytes.fromhex("000b0005"), 3, 5, b"\1")
            for byte in bytes([len(whole)]) + whole:
                sink.line.sendall(bytes([byte]))
            self.assertEqual(sink.news(), "received(11:5 5 x01)")
            code, complaints = sink.end()
            self.assertEqual(code, 0)
            self.assertIn("no active message", complaints)

    def test_packets_that_end_within_their_header(self):
        for size in range(1, 8):
            with self.subTest(size), Forwarder() as sink:
                sink.packet(), sink.news()
                whole = net_msg(bytes.fromhex("000b0005"), 3, 5, b"\1")
                sink.give(whole[:size])
                sink.give(whole)
                self.assertEqual(sink.news(), "received(11:5 5 x01)")

    def test_a_message_that_comes_with_the_handshake(self):
        whole = net_msg(bytes.fromhex("000b0005"), 3, 10, b"OPEN", reliable=1, number=40)
        with Forwarder(b"U " + bytes([len(whole)]) + whole) as sink:
            self.assertEqual({sink.news(), sink.news()},
                             {"op_result(success)", "received(11:5 10 x4f50454e)"})
            packets = [sink.packet(), sink.packet()]
            self.assertIn(packet(37, bytes([10, 0, 11]), dest=1), packets)
            self.assertIn(bytes.fromhex("06090a17002800"), [one[19:26] for one in packets])

    def test_many_messages_at_once(self):
        with Forwarder() as sink:
            sink.packet(), sink.news()
            mote = bytes.fromhex("000b0005")
            flood = [net_msg(mote, 3, 5, bytes([i]), reliable=1, number=i) for i in range(200)]
            sink.line.sendall(b"".join(bytes([len(one)]) + one for one in flood))
            self.assertEqual([sink.news() for _ in flood],
                             [f"received(11:5 5 x{i:02x})" for i in range(200)])
            self.assertEqual([sink.packet()[23:25] for _ in flood],
                             [i.to_bytes(2, "big") for i in range(200)])

    def test_calls_acks_and_a_timeout_in_real_time(self):
        with Forwarder() as sink:
            sink.packet(), sink.news()
            sink.call("send(dest=11:5 app_id=5 reliable=1 data=x0102)")
            first = sink.packet()
            number = int.from_bytes(first[17:19], "big")
            self.assertEqual(sink.news(), f"send_result({number})")
            sink.give(net_msg(bytes.fromhex("000b0005"), 9, 5, bytes([23]) + first[17:19] + b"\0"))
            self.assertEqual(sink.news(), f"ack_received(5 {number} success)")
            started = time.monotonic()
            sink.call("send(dest=11:6 app_id=5 reliable=1 data=x)")
            number = int.from_bytes(sink.packet()[17:19], "big")
            self.assertEqual(sink.news(), f"send_result({number})")
            self.assertEqual(sink.news(), f"ack_received(5 {number} fail)")
            # The node may count from the tick in which the call came: up to one less.
            self.assertGreater(time.monotonic() - started, 999 * TICK_S)
            sink.call("send(dest=11 app_id=5)")
            sink.call("send(dest=12:5 app_id=5 reliable=0 data=x)")
            self.assertRegex(sink.news(), r"send_result\(\d+\)")
            code, complaints = sink.end()
            self.assertEqual(code, 0)
            self.assertIn("not ISLAND:DEVICE", complaints)
            self.assertIn("no way to island 12", complaints)

    def test_a_connection_that_ends_within_a_packet(self):
        with Forwarder() as sink:
            sink.packet(), sink.news()
            sink.line.sendall(b"\x20\0\0")
            code, complaints = sink.end()
            self.assertEqual(code, 1)
            self.assertIn("ended within a packet", complaints)

    def test_something_else_than_a_forwarder(self):
        with Forwarder(hello=b"HT") as sink:
            code, complaints = sink.end()
            self.assertEqual(code, 1)
            self.assertIn("no serial forwarder", complaints)

    def test_usage(self):
        for words in ([], ["localhost", "11"], ["localhost:0", "11"], ["localhost:9002", "65533"],
                      ["localhost:9002", "x"]):
            done = subprocess.run([*COMMAND, *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr[:6]), (2, "usage:"), words)


if __name__ == "__main__":
    COMMAND = [sys.argv[1], "-cp", sys.argv[2], "rubric.basestation.ForwarderClient"]
    unittest.main(argv=sys.argv[:1])
