#!/usr/bin/env python3
"""The clients of `rubric forward`: good ones, bad ones, slow ones, and others' programs.

Usage: forward_test.py RUBRIC. All of it on this host, bounded in time.
"""

import resource
import socket
import struct
import subprocess
import time
import unittest

from forward_testing import SANITIZED, Client, from_mote, packet, serving
from serial_testing import PATIENCE_S, hdlc
from testing import RUBRIC

# A packet that the mote has not confirmed in this time is sent again, which a busy machine may come
# to where the order of packets is the question.
NEVER_AGAIN = ("--timeout", str(1000 * PATIENCE_S))
SOCKET_BYTES = 4096  # Of those who are slow, so that the kernel keeps little for them.


class Clients(unittest.TestCase):
    maxDiff = 2000

    def test_all_clients_get_the_same_in_order(self):
        mote, running = serving(self, terminal=True)
        clients = [Client(self, running) for _ in range(5)]
        wanted = [packet(number, 4 * (number % 20)) for number in range(500)]
        for data in wanted:
            mote.say(from_mote(data))
        for client in clients:
            self.assertEqual(client.packets(len(wanted)), wanted)
        late = Client(self, running)
        mote.say(from_mote(packet(1000)))
        for client in [*clients, late]:
            self.assertEqual(client.packet(), packet(1000))
        code, summary = running.end()
        self.assertEqual((code, summary),
                         (0, f"rubric: {mote.source}: 501 packets from it (0 malformed frames), "
                             "0 to it; 6 clients, 0 cut off"))

    def test_malformed_frames_are_counted_and_not_passed_on(self):
        mote, running = serving(self)
        client = Client(self, running)
        good = from_mote(packet(1))
        mote.say(good[:9] + bytes([good[9] ^ 1]) + good[10:] + b"\x7e\x45\x7e" +
                 b"\x7e" + b"\x45" * 300 + b"\x7e" + hdlc(b"\x43\x07") + from_mote(packet(2)))
        self.assertEqual(client.packet(), packet(2))
        self.assertRegex(running.end()[1], r": 1 packets from it \(3 malformed frames\), 0 to it")

    def test_a_client_that_stops_reading_is_cut_off_alone(self):
        mote, running = serving(self, "--buffer", "64")
        good = Client(self, running)
        stalled = Client(self, running, receive_bytes=SOCKET_BYTES)
        total = 0
        while not any("cut off" in line for line in running.complaints):
            batch = range(total, total + 200)
            mote.say(b"".join(from_mote(packet(number, 100)) for number in batch))
            self.assertEqual(good.packets(200), [packet(number, 100) for number in batch])
            total += 200
            self.assertLess(total, 100_000, "a client that takes nothing is served for ever")
        self.assertRegex(running.wait_for("cut off"),
                         f"^rubric: client {stalled.name} is cut off: it is \\d+ bytes behind and "
                         r"has taken nothing for \d+\.\d s$")
        stalled.wait_until_cut_off()
        mote.say(from_mote(packet(total)))
        self.assertEqual(good.packet(), packet(total))
        self.assertRegex(running.end()[1], f": {total + 1} packets .*; 2 clients, 1 cut off$")

    def test_a_packet_for_the_mote_is_sent_until_it_is_confirmed(self):
        mote, running = serving(self, "--timeout", "100", terminal=True)
        client = Client(self, running)
        client.give(packet(1))
        client.give(packet(2))
        first = mote.frame()
        second = mote.frame()  # Since nothing confirmed the first.
        self.assertEqual((first[0], first[1]), (0x44, 14))
        self.assertEqual((second[0], second[1]), (0x44, 15))
        self.assertEqual({first[2:], second[2:]}, {packet(1)})
        mote.say(hdlc(bytes([0x43, second[1]])))
        content = mote.frame()
        while content[2:] == packet(1):  # It may have been sent once more meanwhile.
            content = mote.frame()
        self.assertEqual(content[2:], packet(2))
        mote.say(hdlc(bytes([0x43, content[1]])))
        client.give(packet(3))
        self.assertEqual(mote.confirmed_packet()[:1], b"\x00")
        mote.say(from_mote(packet(4)))
        self.assertEqual(client.packet(), packet(4))
        self.assertEqual(running.end()[0], 0)

    def test_packets_that_ask_for_it_are_confirmed(self):
        mote, running = serving(self, terminal=True)
        client = Client(self, running)
        mote.say(hdlc(b"\x44\x2a" + packet(1)))
        self.assertEqual(mote.frame(), b"\x43\x2a")
        self.assertEqual(client.packet(), packet(1))
        self.assertEqual(running.end()[0], 0)

    def test_clients_take_turns(self):
        mote, running = serving(self, *NEVER_AGAIN)
        greedy, modest = Client(self, running), Client(self, running)
        for number in range(30):
            greedy.give(packet(number))
        self.assertEqual(mote.frame()[0], 0x44)  # All others wait until it is confirmed.
        for number in range(100, 103):
            modest.give(packet(number))
        Client(self, running)  # What the others sent was read before this one was let in.
        mote.say(hdlc(bytes([0x43, 14])))
        order = [mote.confirmed_packet() for _ in range(32)]
        self.assertEqual([data for data in order if data in map(packet, range(100))],
                         [packet(number) for number in range(1, 30)])
        places = [order.index(packet(number)) for number in range(100, 103)]
        self.assertEqual(places, sorted(places))
        self.assertLess(places[-1], 8, "the packets of one keep those of the other waiting")

    def test_a_mote_that_confirms_nothing(self):
        mote, running = serving(self, "--timeout", "100", "--retries", "2")
        client = Client(self, running)
        for number in range(4):
            client.give(packet(number))
        tries = [mote.frame() for _ in range(12)]
        self.assertEqual([content[2:] for content in tries],
                         [packet(number) for number in range(4) for _ in range(3)])
        running.wait_for("does not confirm a packet")
        mote.say(from_mote(packet(9)))
        self.assertEqual(client.packet(), packet(9))
        client.give(packet(5))
        self.assertEqual(mote.confirmed_packet(), packet(5))
        running.wait_for("the mote confirms packets again")
        code, summary = running.end()
        self.assertEqual(code, 0)
        self.assertRegex(summary, r", 1 to it, 4 not confirmed; 1 clients, 0 cut off$")
        self.assertEqual(len(running.complaints), 3, running.complaints)

    def test_bad_clients_are_cut_off_and_others_are_not(self):
        mote, running = serving(self, "--patience", "1")
        good = Client(self, running)
        for sent, why in ((b"G", "begins with 47, not with 55 20"),
                          (b"U\x1f", "begins with 55 1f, not with 55 20"),
                          (b"U \x00", "sent a packet of no bytes"),
                          (b"U \xfd", "sent a packet of 253 bytes; the source takes 252$"),
                          (b"U", "has not ended its handshake in"),
                          (b"", "has not ended its handshake in"),
                          (b"U \x05\x00\x01", "has not ended its packet in")):
            bad = Client(self, running, hello=sent)
            running.wait_for(f"client {bad.name} is cut off: it {why}")
            bad.wait_until_cut_off()
        left = Client(self, running, hello=b"U \x05\x00")
        left.socket.close()
        running.wait_for(f"client {left.name} is cut off: it left within a packet")
        reset = Client(self, running)
        reset.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        reset.socket.close()
        newer = Client(self, running, hello=b"U!")  # A later version is none of ours, but no fault.
        mote.say(from_mote(packet(1)))
        self.assertEqual([good.packet(), newer.packet()], [packet(1)] * 2)
        newer.give(packet(2))
        self.assertEqual(mote.confirmed_packet(), packet(2))
        self.assertRegex(running.end()[1], "; 11 clients, 8 cut off$")

    def test_what_a_client_sent_before_it_left_is_sent(self):
        mote, running = serving(self, *NEVER_AGAIN)
        for number in range(3):
            client = Client(self, running)
            client.give(packet(number))
            client.give(packet(number + 10))
            client.socket.close()
        found = sorted(mote.confirmed_packet() for _ in range(6))
        self.assertEqual(found, [packet(number) for number in (0, 1, 2, 10, 11, 12)])

    def test_the_silent_give_way(self):
        _, running = serving(self, "--clients", "1", "--patience", "1")
        silent = Client(self, running)
        deadline = time.monotonic() + PATIENCE_S
        served = False
        while not served and time.monotonic() < deadline:
            with socket.create_connection((running.host, running.port), PATIENCE_S) as later:
                later.sendall(b"U ")
                try:
                    served = later.recv(2) == b"U "
                except ConnectionError:
                    pass
                time.sleep(0 if served else 0.5)
        self.assertTrue(served)
        running.wait_for(f"client {silent.name} gives way: it has sent nothing for")

    def test_too_many_clients(self):
        mote, running = serving(self, "--clients", "2", "--verbose")
        clients = [Client(self, running) for _ in range(2)]
        for _ in range(3):
            refused = socket.create_connection((running.host, running.port), PATIENCE_S)
            self.addCleanup(refused.close)
            self.assertEqual(refused.recv(2), b"")
        running.wait_for("is refused: there are 2 already")
        clients[0].socket.close()
        running.wait_for(f"client {clients[0].name} has left")
        third = Client(self, running)
        mote.say(from_mote(packet(1)))
        self.assertEqual([clients[1].packet(), third.packet()], [packet(1)] * 2)
        self.assertRegex(running.end()[1], "; 3 clients, 0 cut off, 3 refused$")
        self.assertEqual(sum("is refused" in line for line in running.complaints), 1)

    def test_who_left_gives_way_while_the_source_is_gone(self):
        mote, running = serving(self, "--clients", "3", "--reconnect")
        mote.listener.close()
        mote.connection.close()
        running.wait_for("the other end closed it")
        names = []
        for number in range(6):
            client = Client(self, running)
            client.give(packet(number))
            client.socket.close()
            names.append(client.name)
        Client(self, running)  # What the others sent was read before this one was let in.
        for name in names[:4]:
            running.wait_for(f"client {name} has left; 1 packets of it are given up")
        self.assertRegex(running.end()[1], ", 6 not sent; 7 clients, 0 cut off$")

    def test_more_clients_than_the_shell_allows_descriptors(self):
        mote, running = serving(self, "--clients", "100", limits="ulimit -S -n 64")
        clients = [Client(self, running) for _ in range(100)]
        mote.say(from_mote(packet(1)))
        self.assertEqual([client.packet() for client in clients], [packet(1)] * 100)
        self.assertRegex(running.end()[1], "; 100 clients, 0 cut off$")

    def test_clients_never_take_the_descriptors_of_the_source(self):
        mote, running = serving(self, "--clients", "500", "--reconnect", limits="ulimit -n 64")
        running.wait_for("^rubric: no more than 32 clients at once: only 64 descriptors are")
        clients = [Client(self, running) for _ in range(32)]
        refused = socket.create_connection((running.host, running.port), PATIENCE_S)
        self.addCleanup(refused.close)
        self.assertEqual(refused.recv(2), b"")
        mote.connection.close()
        mote.accept()
        mote.say(from_mote(packet(1)))
        self.assertEqual([client.packet() for client in clients], [packet(1)] * 32)
        self.assertRegex(running.end()[1], "; 32 clients, 0 cut off, 1 refused$")

    @unittest.skipIf(SANITIZED, "a sanitizer needs descriptors of its own")
    def test_a_wait_that_fails_ends_it(self):
        mote, running = serving(self)
        clients = [Client(self, running) for _ in range(8)]
        # Poll takes no more of them than there may be descriptors.
        resource.prlimit(running.process.pid, resource.RLIMIT_NOFILE, (8, 8))
        mote.say(from_mote(packet(1)))
        clients[0].wait_until_cut_off()
        self.assertEqual(running.end(None),
                         (66, "rubric: cannot wait for source and clients: Invalid argument"))

    def test_what_is_cut_short_after_whole_packets(self):
        mote, running = serving(self, *NEVER_AGAIN)
        first, client = Client(self, running), Client(self, running)
        first.give(packet(1))
        self.assertEqual(mote.frame()[2:], packet(1))  # The others wait until it is confirmed.
        client.give(packet(2))
        client.socket.sendall(b"\x05\x00")
        client.socket.close()
        Client(self, running)  # What the others sent was read before this one was let in.
        mote.say(hdlc(b"\x43\x0e"))
        self.assertEqual(mote.confirmed_packet(), packet(2))
        running.wait_for(f"client {client.name} is cut off: it left within a packet")
        mote.say(from_mote(packet(3)))  # Behind the confirmation, which is then heard, too.
        self.assertEqual(first.packet(), packet(3))
        self.assertRegex(running.end()[1], ", 2 to it; 3 clients, 1 cut off$")

    def test_rubric_decode_is_a_client(self):
        mote, running = serving(self, "--verbose", terminal=True)
        with subprocess.Popen([RUBRIC, "decode", f"sf@127.0.0.1:{running.port}", "--count", "3",
                               "--format", "csv", "--fields", "message,am.type"],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              text=True) as decode:
            running.wait_for("has come")
            mote.say(from_mote(bytes.fromhex("00ffff000003002514000c")) * 3)
            out, _ = decode.communicate(timeout=PATIENCE_S)
        self.assertEqual(out.split()[1:], ["config,37"] * 3)
        running.wait_for("has left")

    def test_rubric_send_is_a_client(self):
        mote, running = serving(self, terminal=True)
        with subprocess.Popen([RUBRIC, "send", "--as", "config", "--to",
                               f"sf@127.0.0.1:{running.port}"], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as send:
            said = send.communicate('{"type":10,"value":12}\n', timeout=PATIENCE_S)
        self.assertEqual(send.returncode, 0, said)
        # It has left, and what it sent is sent all the same.
        self.assertEqual(mote.confirmed_packet(), bytes.fromhex("00ffff00000300250a000c"))


if __name__ == "__main__":
    unittest.main()
