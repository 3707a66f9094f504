#!/usr/bin/env python3
"""rubric-extcap as Wireshark calls it, by hand.

Usage: extcap_test.py RUBRIC RUBRIC_EXTCAP.
"""

import os
import pathlib
import re
import select
import signal
import time
import unittest

from extcap_testing import EXTCAP, FORWARDER, PACKET, SERIAL, Base, decoded, meaning, run
from live_testing import Forwarder
from serial_testing import PATIENCE_S, Pty, hdlc, wait_for
from testing import RUBRIC

UNKNOWN = ["--extcap-version=9.9", "--not-yet-known", "--also-new", "value", "--log-level=debug"]
# As Wireshark takes them apart.
SENTENCE = re.compile(r"(arg|value|interface|extcap|dlt) ((?:\{[a-z]+=.*?\}(?=\{|$))+)$")
VALUE = re.compile(r"\{([a-z]+)=(.*?)\}(?=\{|$)")


def sentences(text):
    found = []
    for line in text.splitlines():
        match = SENTENCE.match(line)
        assert match, line
        found.append((match[1], dict(VALUE.findall(match[2]))))
    return found


class Calls(Base):
    """Each call of the protocol, by hand."""

    def said(self, *words, code=0):
        done = run(EXTCAP, *words, env=self.environment)
        self.assertEqual((done.returncode, done.stderr if code == 0 else ""), (code, ""), done)
        return done.stdout

    def test_interfaces(self):
        for words in (["--extcap-interfaces"], ["--extcap-interfaces", "--extcap-version=4.0"],
                      ["--extcap-version", "4.4", "--extcap-interfaces"],
                      ["--extcap-interfaces", *UNKNOWN]):
            extcap, interface = sentences(self.said(*words))
            self.assertEqual((extcap[0], interface[0]), ("extcap", "interface"))
            self.assertRegex(extcap[1]["version"], r"^\d+\.\d+\.\d+$")
            self.assertEqual(interface[1]["value"], "rubric")

    def test_link_types(self):
        for more in ([], UNKNOWN):
            found = sentences(self.said("--extcap-dlts", "--extcap-interface", "rubric", *more))
            self.assertEqual([(kind, values["number"], values["name"]) for kind, values in found],
                             [("dlt", "147", "USER0"), ("dlt", "148", "USER1")])

    def test_config(self):
        for more in ([], UNKNOWN):
            found = sentences(self.said("--extcap-config", "--extcap-interface=rubric", *more))
            arguments = [values for kind, values in found if kind == "arg"]
            self.assertEqual([one["number"] for one in arguments], ["0", "1", "2", "3", "4"])
            self.assertEqual([one["call"] for one in arguments],
                             ["--source", "--other-source", "--listen-only", "--reconnect",
                              "--spec"])
            for one in arguments:
                self.assertIn(one["type"], ("selector", "string", "boolflag"))
            values = [values for kind, values in found if kind == "value"]
            self.assertLessEqual({one["arg"] for one in values}, {"0", "4"})
            chosen = [one["value"] for one in values if one["default"] == "true"]
            self.assertEqual(chosen, ["sf@localhost:9002", "rubicon"])

    def test_other_sources_are_validated_as_they_are_read(self):
        found = sentences(self.said("--extcap-config", "--extcap-interface", "rubric"))
        pattern = next(values["validation"] for kind, values in found
                       if values.get("call") == "--other-source")
        for text, right in (("serial@/dev/my mote:telosb", True), ("sf@host:9002", True),
                            ("", True), ("network@::1:99", True), ("serial@/dev/ttyUSB0", False),
                            ("host:9002", False), ("sf@host", False)):
            self.assertEqual(bool(re.search(pattern, text)), right, text)

    def test_reload(self):
        for name in ("--source", "source"):
            found = sentences(self.said("--extcap-config", "--extcap-interface", "rubric",
                                        "--extcap-reload-option", name, "--source", "x"))
            self.assertEqual({(kind, values["arg"]) for kind, values in found}, {("value", "0")})

    def test_the_default_source_is_motecom(self):
        self.environment["MOTECOM"] = "serial@/dev/ttyS0:micaz"
        text = self.said("--extcap-config", "--extcap-interface", "rubric")
        self.assertIn("{value=serial@/dev/ttyS0:micaz}", text)
        self.environment["MOTECOM"] = "odd}{value"
        text = self.said("--extcap-config", "--extcap-interface", "rubric")
        self.assertIn("{value=sf@localhost:9002}", text)

    def test_filters(self):
        ask = ["--extcap-interface", "rubric", "--extcap-capture-filter"]
        self.assertEqual(self.said(*ask, "message==updates && src.devid==4", *UNKNOWN), "")
        self.assertEqual(self.said(*ask, ""), "")
        self.assertRegex(self.said(*ask, "mesage==updates", code=64),
                         r"^unknown name 'mesage' \(did you mean 'message'\?\)\n$")
        self.assertEqual(self.said(*ask, "reading.nreadings==1", "--spec", "oscilloscope", code=64),
                         self.said(*ask, "reading.nreadings==1", code=64))

    def test_bad_calls(self):
        for words, what in (([], "nothing to do"), (UNKNOWN, "nothing to do"),
                            (["--extcap-dlts", "--extcap-interface", "eth0"], "'eth0'"),
                            (["--capture", "--extcap-interface", "rubric"], "needs --fifo"),
                            (["--capture", "--fifo"], "--fifo needs a value")):
            done = run(EXTCAP, *words, env=self.environment)
            self.assertEqual((done.returncode, done.stdout), (64, ""), words)
            self.assertIn(what, done.stderr)

    def test_help_and_version(self):
        for option in ("--extcap-interfaces", "--source", "--reconnect", "--other-source"):
            self.assertIn(option, self.said("--help"))
        self.assertEqual(self.said("--version"), run(RUBRIC, "--version").stdout)


class Captures(Base):
    """--capture by hand, into a pipe and into a file."""

    def setUp(self):
        super().setUp()
        self.fifo = self.folder / "fifo"
        os.mkfifo(self.fifo)
        self.got = b""

    def capture(self, source, *more, fifo=None):
        return self.started(EXTCAP, "--capture", "--extcap-interface", "rubric", "--fifo",
                            fifo or self.fifo, "--source", source, *more)

    def reader(self):
        return os.open(self.fifo, os.O_RDONLY)

    def read(self, fd, enough):
        """Until `enough` holds of what was read, or the writer closed the pipe."""
        deadline = time.monotonic() + PATIENCE_S
        while not enough(self.got):
            ready = select.select([fd], [], [], max(0, deadline - time.monotonic()))[0]
            self.assertTrue(ready, f"no more after {len(self.got)} bytes")
            more = os.read(fd, 1 << 16)
            if not more:
                break
            self.got += more

    def records(self):
        path = self.folder / "got.pcapng"
        path.write_bytes(self.got)
        return decoded(path)

    def test_a_serial_forwarder_until_sigterm(self):
        server = Forwarder(self)
        process = self.capture(f"sf@127.0.0.1:{server.port}", *UNKNOWN)
        fd = self.reader()
        self.addCleanup(os.close, fd)
        connection = server.accept(FORWARDER.read_bytes())
        wanted = decoded(FORWARDER)
        self.read(fd, lambda _: len(self.records()) == len(wanted))
        self.assertEqual(meaning(self.records()), meaning(wanted))
        self.assertEqual({one["link_type"] for one in self.interfaces()}, {148})
        process.send_signal(signal.SIGTERM)
        self.read(fd, lambda _: False)
        code, err = self.ended(process)
        self.assertEqual((code, err.splitlines()), (0, []))
        self.assertEqual(connection.recv(1), b"")
        self.assertEqual(meaning(self.records()), meaning(wanted))

    def interfaces(self):
        """Interface descriptions of what was read."""
        found = []
        at = 0
        while at + 12 <= len(self.got):
            kind = int.from_bytes(self.got[at:at + 4], "little")
            size = int.from_bytes(self.got[at + 4:at + 8], "little")
            if kind == 1:
                found.append({"link_type": int.from_bytes(self.got[at + 8:at + 10], "little")})
            at += size
        return found

    def test_serial_lines_of_both_kinds(self):
        line = Pty(self)
        place = self.folder / "my mote"
        place.symlink_to(line.name)
        server = Forwarder(self)
        frame = hdlc(b"\x44\x2a" + PACKET)
        for source in (f"serial@{place}:telosb", f"network@127.0.0.1:{server.port}"):
            with self.subTest(source):
                self.got = b""
                process = self.capture("sf@nobody:1", "--other-source", source,
                                       *(["--listen-only"] if "network" in source else []))
                fd = self.reader()
                if "network" in source:
                    connection = server.line()
                    connection.sendall(frame)
                else:
                    self.write_until_read(line, frame, fd)
                self.read(fd, lambda _: self.records())
                records = self.records()
                self.assertEqual({one["link_type"] for one in self.interfaces()}, {147})
                self.assertEqual(records[0]["message"], "config")
                self.assertEqual(records[0]["frame"]["serial_seq"], 0x2a)
                self.assertEqual(records[0]["interface"], source)
                self.assertLess(abs(records[0]["time"] - time.time()), 2 * PATIENCE_S)
                if "network" in source:
                    process.send_signal(signal.SIGINT)
                    self.assertEqual(self.ended(process), (0, ""))
                    self.assertEqual(connection.recv(1), b"")  # Nothing was confirmed.
                else:
                    self.assertTrue(line.take(len(hdlc(b"\x43\x2a"))).startswith(hdlc(b"\x43\x2a")))
                    process.send_signal(signal.SIGTERM)
                    self.assertEqual(self.ended(process), (0, ""))
                os.close(fd)

    def write_until_read(self, line, frame, fd):
        """Opening a serial device throws away what came before: nobody knows when that is over."""
        deadline = time.monotonic() + PATIENCE_S
        while not self.records() and time.monotonic() < deadline:
            os.write(line.fd, frame)
            while select.select([fd], [], [], 0.2)[0]:
                self.got += os.read(fd, 1 << 16)

    def test_a_capture_filter(self):
        server = Forwarder(self)
        self.capture(f"network@127.0.0.1:{server.port}", "--extcap-capture-filter",
                     "message==serial_joined || error")
        fd = self.reader()
        self.addCleanup(os.close, fd)
        connection = server.line()
        connection.sendall(SERIAL.read_bytes() + hdlc(b"\x45" + PACKET, wrong=1))
        wanted = [one for one in decoded(SERIAL) if one["message"] == "serial_joined"]
        self.assertGreater(len(wanted), 1)
        self.read(fd, lambda _: len(self.records()) == len(wanted) + 1)
        self.assertEqual(meaning(self.records()[:-1]), meaning(wanted))
        self.assertEqual(self.records()[-1]["error"]["fault"], "crc")

    def test_a_reader_that_goes_ends_it(self):
        """Even when nothing comes that could be written."""
        server = Forwarder(self)
        for more in ([], ["--reconnect"]):
            with self.subTest(more):
                process = self.capture(f"sf@127.0.0.1:{server.port}", *more)
                fd = self.reader()
                connection = server.accept(b"")
                if more:  # Lost, and waiting for its return.
                    server.listener.close()
                    connection.close()
                os.close(fd)
                code, err = self.ended(process)
                self.assertEqual(code, 0, err)

    def test_sigterm_before_anybody_reads(self):
        process = self.capture("sf@127.0.0.1:1")

        def handles_signals():
            rows = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
            caught = int(re.search(r"SigCgt:\s*([0-9a-f]+)", rows)[1], 16)
            return caught >> (signal.SIGTERM - 1) & 1
        wait_for(handles_signals, "the program handles signals")
        wait_for(lambda: "S" == pathlib.Path(f"/proc/{process.pid}/stat").read_text(
            encoding="utf-8").rsplit(")", 1)[1].split()[0], "it sleeps")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(self.ended(process), (0, ""))

    def test_sources_that_cannot_be(self):
        for source, code, what in (
                ("serial@/no/such:57600", 66, "/no/such: cannot be opened"),
                ("serial@/no such/mote:57600", 66, "/no such/mote: cannot be opened"),
                ("serial@/dev/null:115200", 66, "is not a serial line"),
                ("sf@127.0.0.1:1", 66, "cannot connect"),
                ("serial@/dev/ttyUSB0", 64, "expected serial@DEVICE:BAUD"),
                ("sf@nowhere", 64, "expected HOST:PORT"),
                (SERIAL, 64, "expected serial@DEVICE:BAUD, network@HOST:PORT or sf@")):
            process = self.capture(source)
            fd = self.reader()  # It is opened before anything fails: Wireshark waits for that.
            self.got = b""
            self.read(fd, lambda _: False)
            os.close(fd)
            found, err = self.ended(process)
            self.assertEqual(found, code, err)
            self.assertIn(what, err)
            self.assertEqual(self.got[:4], bytes.fromhex("0a0d0d0a"))
        process = self.capture("sf@127.0.0.1:1", "--extcap-capture-filter", "message=")
        fd = self.reader()
        found, err = self.ended(process)
        os.close(fd)
        self.assertEqual(found, 64)
        self.assertIn("capture filter: ", err)

    def test_a_peer_that_goes(self):
        server = Forwarder(self)
        process = self.capture(f"sf@127.0.0.1:{server.port}")
        fd = self.reader()
        self.addCleanup(os.close, fd)
        server.accept(FORWARDER.read_bytes()).close()
        self.read(fd, lambda _: False)
        code, err = self.ended(process)
        self.assertEqual(code, 66)
        self.assertIn("the other end closed it", err)
        self.assertEqual(meaning(self.records()), meaning(decoded(FORWARDER)))

    def test_pipes_that_cannot_be(self):
        process = self.capture("sf@127.0.0.1:1", fifo=self.folder / "no" / "fifo")
        code, err = self.ended(process)
        self.assertEqual(code, 74)
        self.assertIn("No such file or directory", err)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["fifo", "home"])


if __name__ == "__main__":
    unittest.main()
