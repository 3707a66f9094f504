#!/usr/bin/env python3
"""The sources of `rubric forward`, and where it listens.

Usage: forward_source_test.py RUBRIC. All of it on this host, bounded in time.
"""

import os
import pty
import socket
import subprocess
import tty
import unittest

from forward_testing import SANITIZED, Client, Mote, Running, from_mote, packet, serving
from serial_testing import PATIENCE_S, hdlc, held_port
from testing import RUBRIC, Folder, rubric


class Sources(Folder):
    maxDiff = 2000

    def test_a_source_that_goes(self):
        mote, running = serving(self)
        client = Client(self, running)
        wanted = [packet(number, 100) for number in range(200)]
        mote.say(b"".join(map(from_mote, wanted)))
        mote.connection.close()
        self.assertEqual(client.packets(200), wanted)
        client.wait_until_cut_off()
        code, summary = running.end(None)
        self.assertEqual(code, 66)
        self.assertIn("200 packets from it", summary)
        running.wait_for(f"^rubric: {mote.source}: the line broke: the other end closed it$")

    def test_who_comes_too_late_does_not_keep_it_awake(self):
        mote, running = serving(self)
        Client(self, running, receive_bytes=4096)  # It takes nothing: the rest is waited for.
        mote.say(b"".join(from_mote(packet(number, 100)) for number in range(8000)))
        mote.connection.close()
        running.wait_for("the line broke")
        with socket.socket() as late:
            late.settimeout(PATIENCE_S)
            late.connect_ex((running.host, running.port))
            self.assertEqual(running.end(None)[0], 66)
        self.assertLess(running.cpu_seconds, 0.3)

    def test_a_source_that_comes_back(self):
        mote, running = serving(self, "--reconnect")
        client = Client(self, running)
        for number in range(2):
            mote.say(from_mote(packet(number)))
            self.assertEqual(client.packet(), packet(number))
            if number == 1:  # It goes with a packet that it has not confirmed.
                client.give(packet(7))
                self.assertEqual(mote.frame()[2:], packet(7))
            mote.connection.close()
            mote.accept()
        self.assertEqual(mote.confirmed_packet(), packet(7))
        mote.say(from_mote(packet(3)))
        self.assertEqual(client.packet(), packet(3))
        code, summary = running.end()
        self.assertEqual(code, 0)
        self.assertRegex(summary, ": 3 packets from it .*, 1 to it; 1 clients, 0 cut off$")
        self.assertEqual(sum("the other end closed it" in line for line in running.complaints), 2)
        self.assertEqual(sum(line.endswith(": again") for line in running.complaints), 2)

    def test_a_device_that_is_unplugged(self):
        name = self.folder / "ttyUSB0"
        running = None
        for number in range(2):
            master, slave = pty.openpty()
            tty.setraw(master)
            name.symlink_to(os.ttyname(slave))
            if running is None:
                running = Running(self, f"serial@{name}:57600", "--reconnect")
                client = Client(self, running)
            else:
                running.wait_for(": again")
            os.write(master, from_mote(packet(number)))
            self.assertEqual(client.packet(), packet(number))
            name.unlink()
            os.close(slave)
            os.close(master)
        self.assertEqual(running.end()[0], 0)

    def test_sources_that_cannot_be(self):
        for source, code, what in (("serial@/no/such:57600", 66, "cannot be opened"),
                                   ("sf@127.0.0.1:1", 66, "cannot connect"),
                                   ("serial@/dev/ttyUSB0", 64, "expected serial@DEVICE:BAUD"),
                                   ("capture.pcapng", 64, "expected serial@DEVICE:BAUD, network")):
            self.refused(("forward", source, "--port", "0"), what, code)
        environment = {key: value for key, value in os.environ.items() if key != "MOTECOM"}
        done = subprocess.run([RUBRIC, "forward", "--port", "0"], capture_output=True, text=True,
                              check=False, timeout=PATIENCE_S, env=environment)
        self.assertEqual(done.returncode, 64)
        self.assertIn("SOURCE", done.stderr)

    def test_a_source_that_is_no_forwarder(self):
        mote = Mote(self).on_a_port()
        running = subprocess.Popen([RUBRIC, "forward", "--port", "0",
                                    mote.source.replace("network", "sf")],
                                   stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        mote.accept()
        mote.say(b"SSH-2.0")
        out, err = running.communicate(timeout=PATIENCE_S)
        self.assertEqual((running.returncode, out), (66, ""))
        self.assertIn("the other end is not a serial forwarder: it does not begin with 55 20", err)

    def test_a_forwarder_of_a_forwarder(self):
        mote = Mote(self).on_a_terminal()
        first = Running(self, mote.source)
        second = Running(self, f"sf@127.0.0.1:{first.port}")
        near, far = Client(self, first), Client(self, second)
        wanted = [packet(number) for number in range(100)]
        mote.say(b"".join(map(from_mote, wanted)))
        self.assertEqual(near.packets(100), wanted)
        self.assertEqual(far.packets(100), wanted)
        far.give(packet(1))
        near.give(packet(2))
        self.assertEqual(sorted(mote.confirmed_packet() for _ in range(2)), [packet(1), packet(2)])
        self.assertEqual(first.end()[0], 0)
        self.assertEqual(second.end(None)[0], 66)

    def test_a_forwarder_of_itself(self):
        for more in ([], ["--bind", "0.0.0.0"]):
            with held_port() as port:
                self.refused(("forward", f"sf@127.0.0.1:{port}", "--port", port, *more),
                             "this is where this forwarder itself listens", 66)

    def test_the_same_port_of_another_address_is_another_forwarder(self):
        mote = Mote(self).on_a_terminal()
        first = Running(self, mote.source)
        second = Running(self, f"sf@127.0.0.1:{first.port}", "--bind", "127.0.0.2",
                         port=first.port)
        client = Client(self, second)
        mote.say(from_mote(packet(1)))
        self.assertEqual(client.packet(), packet(1))

    @unittest.skipIf(SANITIZED, "a sanitizer needs descriptors of its own")
    def test_a_source_without_a_descriptor(self):
        mote = Mote(self).on_a_port()
        done = subprocess.run(["sh", "-c", 'ulimit -n 4; exec "$@"', "sh",  # Three, and it listens.
                               RUBRIC, "forward", mote.source, "--port", "0"],
                              capture_output=True, text=True, check=False, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 66)
        self.assertIn("cannot connect: Too many open files", done.stderr)

    def test_a_port_that_is_taken(self):
        mote, running = serving(self, terminal=True)
        self.refused(("forward", mote.source, "--port", str(running.port)),
                     f"cannot listen at 127.0.0.1, port {running.port}: Address already in use", 66)

    def test_other_hosts_are_let_in_only_aloud(self):
        mote, running = serving(self, terminal=True)
        self.assertEqual(running.host, "127.0.0.1")
        self.assertEqual(running.end()[0], 0)
        self.assertFalse(any("WARNING" in line for line in running.complaints))
        running = Running(self, mote.source, "--bind", "0.0.0.0")
        running.wait_for("WARNING: 0.0.0.0:.* can be reached from other hosts")
        self.assertEqual(running.end()[0], 0)

    def test_ipv6(self):
        try:
            socket.create_server(("::1", 0), family=socket.AF_INET6).close()
        except OSError:
            self.skipTest("this host has no IPv6")
        mote, running = serving(self, "--bind", "::1", terminal=True)
        client = Client(self, running)
        mote.say(from_mote(packet(1)))
        self.assertEqual(client.packet(), packet(1))

    def test_listen_only(self):
        mote, running = serving(self, "--listen-only")
        client = Client(self, running)
        client.give(packet(1))
        client.give(packet(2))
        mote.say(hdlc(b"\x44\x2a" + packet(3)))
        self.assertEqual(client.packet(), packet(3))
        Client(self, running)
        self.assertRegex(running.end()[1], ", 0 to it, 2 not sent; ")
        self.assertEqual(mote.connection.read(100), b"")

    def test_what_goes_by_is_kept(self):
        kept = self.folder / "kept.pcapng"
        mote, running = serving(self, "--write", kept)
        client = Client(self, running)
        mote.say(from_mote(packet(1)))
        self.assertEqual(client.packet(), packet(1))
        client.give(packet(2))
        self.assertEqual(mote.confirmed_packet(), packet(2))
        mote.say(from_mote(packet(3)))
        self.assertEqual(client.packet(), packet(3))
        self.assertEqual(running.end()[0], 0)
        out = rubric("decode", kept, "--format", "csv", "--fields", "direction,frame.kind")[1]
        self.assertEqual(out.split()[1:],
                         ["outbound,69", "inbound,68", "outbound,67", "outbound,69"])

    def test_a_capture_that_cannot_be_written_is_reported_at_once(self):
        kept = self.folder / "kept.pcapng"
        mote = Mote(self).on_a_port()
        running = Running(self, mote.source, "--write", kept,
                          limits="trap '' XFSZ; ulimit -f 8")  # Of 512 bytes each.
        mote.accept()
        client = Client(self, running)
        mote.say(from_mote(packet(1, 100)) * 100)
        running.wait_for(f"^rubric: cannot write {kept}: File too large$")
        mote.say(from_mote(packet(2)))
        self.assertEqual(client.packets(101)[-1], packet(2))
        self.assertEqual(running.end()[0], 74)
        self.assertEqual(sum("File too large" in line for line in running.complaints), 1)

    def test_a_capture_is_a_regular_file(self):
        pipe = self.folder / "kept.pcapng"
        os.mkfifo(pipe)
        reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        self.refused(("forward", "sf@127.0.0.1:1", "--port", "0", "--write", pipe),
                     f"--write: {pipe} is not a regular file")


if __name__ == "__main__":
    unittest.main()
