#!/usr/bin/env python3
"""`rubric send`: input that is wrong, lines that cannot be had, and serial forwarders.

Usage: send_input_test.py RUBRIC. The forwarders are this test's.
"""

import json
import socket
import subprocess
import threading
import time
import unittest

from live_testing import lines_of
from send_testing import (CLEAN, INPUT, LONG_MS, NOT_SENT, USAGE, Base, config, confirms, line,
                          send)
from serial_testing import ACK, PACKET_NOACK, PATIENCE_S, hdlc
from testing import rubric


class Input(Base):
    def test_bad_lines_are_reported_and_not_sent(self):
        to, mote = self.mote(confirms)
        text = line(1) + '{"type":10,"value":70000}\n' + "{\n" + '{"kind":1}\n' + line(2)
        code, out, err = send("--as", "config", "--to", to, "--timeout", LONG_MS, text=text)
        self.assertEqual(code, INPUT)
        self.assertEqual(out.count("confirmed after 1 try"), 2)
        self.assertRegex(err, r"(?m)^rubric: stdin:2: value: expected .*70000")
        self.assertRegex(err, r"(?m)^rubric: stdin:3:\d+: ")
        self.assertRegex(err, r"(?m)^rubric: stdin:4: ")
        mote.end()
        self.assertEqual(mote.packets, [(14, config(1)), (15, config(2))])

    def test_what_is_no_packet_of_a_serial_line(self):
        to, mote = self.mote(confirms)
        radio = lines_of("spec/captures/firmware/a_join_data.pcapng", "--filter",
                         "framing==radio", "--count", "1")[0]
        broken = hdlc(b"\x45" + config(1)).replace(config(1)[-2:], config(2)[-2:])
        malformed = json.loads(rubric("decode", "--format", "jsonl", "--input-format", "hdlc",
                                      stdin=broken)[1])
        long = {"schema": "rubric.decode/1", "framing": "sf", "raw": "00" * 253}
        path = self.write("odd.jsonl", "".join(json.dumps(row) + "\n"
                                               for row in (radio, malformed, long)))
        code, out, err = send(path, "--to", to)
        self.assertEqual((code, out), (INPUT, ""))
        self.assertIn(f"rubric: {path}:1: expected a serial packet, given a radio frame\n", err)
        self.assertIn(f"rubric: {path}:2: a malformed frame cannot be sent as it is: ", err)
        self.assertIn(f"rubric: {path}:3: expected a packet of at most 252 bytes from the dispatch "
                      "byte on, as a mote's serial line takes, given 253\n", err)
        mote.end()
        self.assertEqual(mote.bytes, b"")

    def test_usage(self):
        for arguments, what in (
                (("--to", "nowhere"), "'nowhere': expected serial@DEVICE:BAUD, network@HOST:PORT "
                                      "or sf@HOST:PORT"),
                (("--to", "serial@/dev/null:fast"), "expected serial@DEVICE:BAUD"),
                (("--to", ""), "is empty"),
                (("serial@/dev/ttyUSB0:telosb",), "is where to: --to serial@/dev/ttyUSB0:telosb"),
                (("--dest", "1"), "go with --as MESSAGE"),
                (("--as", "cofnig"), "did you mean"),
                (("--as", "updates"), "no AM type carries updates itself on serial lines; give "
                                      "--am-type, or send the message that it travels in"),
                (("--timeout", "0"), "--timeout"),
                (("--retries", "-1"), "--retries"),
                (("--listen", "-1"), "--listen")):
            code, out, err = send("--to", "serial@/dev/null:telosb", *arguments) \
                if "--to" not in arguments else send(*arguments)
            self.assertEqual((code, out), (USAGE, ""), arguments)
            self.assertIn(what, err)
        code, _, err = send(env={"MOTECOM": "telepathy"})
        self.assertEqual(code, USAGE)
        self.assertIn("$MOTECOM: 'telepathy': expected", err)

    def test_lines_that_cannot_be_had(self):
        silent = socket.socket()
        self.addCleanup(silent.close)
        silent.bind(("127.0.0.1", 0))  # And nobody listens there.
        for to, what in (("serial@/dev/null:115200", "is not a serial line"),
                         ("serial@/no/such:57600", "cannot be opened"),
                         (f"network@127.0.0.1:{silent.getsockname()[1]}", "cannot connect")):
            code, out, err = send("--as", "config", "--to", to, text=line(1))
            self.assertEqual((code, out), (NOT_SENT, ""), to)
            self.assertIn(f"rubric: {to}: ", err)
            self.assertIn(what, err)
            self.assertIn("rubric: 0 packets, 0 confirmed\n", err)

    def test_a_file_that_is_not_there(self):
        to, _ = self.mote(confirms)
        code, _, err = send(self.folder / "none.jsonl", "--to", to)
        self.assertEqual(code, INPUT)
        self.assertIn("none.jsonl: No such file or directory", err)


class SerialForwarder(Base):
    def test_packets_and_their_end(self):
        """All of it arrives, though the forwarder sends all the while what nobody reads."""
        got = []

        def serve(connection):
            flood = (bytes([11]) + config(9)) * 500
            whole = b""
            while more := connection.recv(1 << 16):
                whole += more
                connection.sendall(flood)
                time.sleep(0.01)
            got.append(whole)

        to, thread = self.forwarder(serve)
        code, out, err = send("--as", "config", text="".join(line(i) for i in range(200)),
                              env={"MOTECOM": to})
        self.assertEqual(code, CLEAN, err)
        self.assertEqual(err, "rubric: 200 packets sent\n")
        self.assertEqual(out.splitlines()[199], " 200  config          sent")
        thread.join(PATIENCE_S)
        self.assertEqual(got, [b"".join(bytes([11]) + config(i) for i in range(200))])

    def long_packets(self, count):
        """A file with so many of 255 bytes, with their numbers."""
        path = self.folder / "long.jsonl"
        with open(path, "w", encoding="utf-8") as file:
            for i in range(count):
                file.write(json.dumps({"schema": "rubric.decode/1", "framing": "sf",
                                       "raw": f"{i:010x}" + 250 * "00"}) + "\n")
        return path

    def test_one_that_writes_first(self):
        """It reads nothing until all of what it says in two seconds is taken."""
        count, got = 20_000, []

        def serve(connection):
            until = time.monotonic() + 2
            while time.monotonic() < until:
                connection.sendall((bytes([255]) + bytes(255)) * 256)
            whole = bytearray()
            while more := connection.recv(1 << 16):
                whole += more
            got.extend(int.from_bytes(whole[at + 1:at + 6], "big") if whole[at] == 255 else None
                       for at in range(0, len(whole), 256))

        to, thread = self.forwarder(serve, receive_bytes=4096)
        code, _, err = send(self.long_packets(count), "--to", to)
        self.assertEqual((code, err), (CLEAN, f"rubric: {count} packets sent\n"))
        thread.join(PATIENCE_S)
        self.assertEqual(got, list(range(count)))

    def test_one_that_never_reads(self):
        done = threading.Event()
        to, _ = self.forwarder(lambda _: done.wait(PATIENCE_S), receive_bytes=4096)
        self.addCleanup(done.set)
        code, out, err = send(self.long_packets(50_000), "--to", to)
        self.assertEqual(code, NOT_SENT)
        self.assertRegex(out.splitlines()[-1], r"^ *\d+  AM type 0 +not sent$")
        self.assertIn(f"rubric: {to}: the line takes no more bytes\n", err)

    def test_what_is_answered_is_shown(self):
        def serve(connection):
            connection.sendall(connection.recv(12))
            connection.recv(1)

        to, _ = self.forwarder(serve)
        running = self.started("send", "--as", "config", "--to", to, "--listen", "600", "--format",
                               "jsonl", stdin=subprocess.PIPE)
        running.process.stdin.write(line(5).encode())
        running.process.stdin.flush()
        self.assertEqual(running.lines(1)[0]["fields"], {"type": 10, "type_name": "set_island_id",
                                                         "value": 5})
        code, _, err = running.end()
        self.assertEqual(code, CLEAN, err)
        self.assertEqual(err, "   1  config          sent\nrubric: 1 packet sent, 1 came\n")

    def test_through_rubric_forward_to_a_mote(self):
        """More packets than wait there at a time, and what the mote says to the last."""
        last = 199

        def answer(_, seq, packet):
            said = hdlc(bytes([PACKET_NOACK]) + config(7)) if packet == config(last) else b""
            return hdlc(bytes([ACK, seq])) + said

        to, mote = self.mote(answer)
        forward = self.started("forward", to, "--port", "0")
        port = forward.text_lines(1)[0].rpartition(":")[2]
        running = self.started("send", "--as", "config", "--to", f"sf@127.0.0.1:{port}",
                               "--listen", "600", "--format", "jsonl", stdin=subprocess.PIPE)
        running.process.stdin.write("".join(line(i) for i in range(last + 1)).encode())
        running.process.stdin.close()
        self.assertEqual(running.lines(1)[0]["fields"]["value"], 7)
        code, _, err = running.end()
        self.assertEqual(code, CLEAN, err)
        self.assertEqual(forward.end()[0], CLEAN)
        mote.end()
        self.assertEqual([packet for _, packet in mote.packets],
                         [config(i) for i in range(last + 1)])

    def test_who_is_no_forwarder(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            listener.settimeout(PATIENCE_S)
            to = f"sf@127.0.0.1:{listener.getsockname()[1]}"

            def greet():
                connection, _ = listener.accept()
                with connection:
                    connection.sendall(b"SSH-2.0\r\n")
                    connection.recv(100)

            thread = threading.Thread(target=greet, daemon=True)
            thread.start()
            code, out, err = send("--as", "config", "--to", to, text=line(1))
            thread.join(PATIENCE_S)
        self.assertEqual((code, out), (NOT_SENT, ""))
        self.assertIn(f"rubric: {to}: the other end is not a serial forwarder's: it begins with 53 "
                      "53, not with 55 20\n", err)

    def test_a_forwarder_that_serves_another(self):
        for command in (("send", "--as", "config", "--to"), ("decode",), ("forward",)):
            for reads in (False, True):  # Unread bytes make it a reset.
                with self.subTest(command), socket.create_server(("127.0.0.1", 0)) as listener:
                    listener.settimeout(PATIENCE_S)
                    to = f"sf@127.0.0.1:{listener.getsockname()[1]}"
                    more = ("--port", "0") if command == ("forward",) else ()
                    running = self.started(*command, to, *more, stdin=subprocess.PIPE)
                    connection, _ = listener.accept()
                    with connection:
                        connection.recv(2, 0 if reads else socket.MSG_PEEK)
                    said = f"rubric: {to}: the other end closed it before it began: it may serve " \
                           "another program; 'rubric forward' shares it\n"
                    self.assertIn(said, running.end(None)[2])

    def test_a_forwarder_that_goes(self):
        def serve(connection):
            connection.recv(12)

        to, _ = self.forwarder(serve)
        running = self.started("send", "--as", "config", "--to", to, stdin=subprocess.PIPE)
        running.process.stdin.write(line(1).encode())
        running.process.stdin.flush()
        self.assertIn("sent", running.text_lines(1)[0])
        code, _, err = running.end(None)
        self.assertEqual(code, NOT_SENT)
        self.assertIn(f"rubric: {to}: the line broke: ", err)


if __name__ == "__main__":
    unittest.main()
