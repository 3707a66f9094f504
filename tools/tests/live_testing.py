"""Helpers of the tests of lines in use: the program, and the other ends of lines.

All of it is on this host, and bounded in time.
"""

import json
import os
import select
import signal
import socket
import subprocess
import threading
import unittest

from serial_testing import PACKET_ACK, PATIENCE_S, read_until, unframed, wait_for
from testing import ROOT, RUBRIC, Folder, rubric


def lines_of(path, *arguments):
    out = rubric("decode", ROOT / path, "--format", "jsonl", *arguments)[1]
    return [json.loads(line) for line in out.splitlines()]


def load_tests(_loader, tests, _pattern):
    """For unittest: the share of the tests that a ctest entry with PARTS takes."""
    parts = int(os.environ.get("GTEST_TOTAL_SHARDS", "1"))
    part = int(os.environ.get("GTEST_SHARD_INDEX", "0"))
    return unittest.TestSuite([test for suite in tests for test in suite][part::parts])


class Running:
    """A rubric that is read and ended by somebody else."""

    def __init__(self, *arguments, **more):
        self.process = subprocess.Popen([RUBRIC, *map(str, arguments)], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, **more)
        self.read = b""

    def text_lines(self, count):
        """The next lines."""
        self.read, came = read_until(self.process.stdout.fileno(),
                                     lambda got: got.count(b"\n") >= count, self.read)
        if not came:
            self.process.kill()
            raise AssertionError(f"{self.read.count(10)} of {count} lines: {self.end(None)}")
        *found, self.read = self.read.split(b"\n", count)
        return [line.decode() for line in found]

    def lines(self, count):
        """The next lines, as JSON."""
        return [json.loads(line) for line in self.text_lines(count)]

    def end(self, signal_number=signal.SIGINT):
        """Exit code and the rest of stdout and stderr. None: it ends by itself."""
        if signal_number is None and self.process.stdin:
            self.process.wait(PATIENCE_S)  # Before its stdin ends.
        if signal_number is not None:
            self.process.send_signal(signal_number)
        if self.process.stdin and self.process.stdin.closed:
            self.process.stdin = None  # Else communicate() closes it again.
        out, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, out.decode(), err.decode()


class Forwarder:
    """The server's end of a serial forwarder connection."""

    def __init__(self, test, port=0):
        self.listener = socket.create_server(("127.0.0.1", port))
        self.listener.settimeout(PATIENCE_S)
        self.port = self.listener.getsockname()[1]
        self.test = test
        test.addCleanup(self.listener.close)

    def line(self):
        """A connection without a handshake, as one of a serial line has none."""
        connection, _ = self.listener.accept()
        connection.settimeout(PATIENCE_S)
        self.test.addCleanup(connection.close)
        return connection

    def accept(self, data):
        connection = self.line()
        if connection.recv(2) != b"U ":
            raise AssertionError("no handshake")
        connection.sendall(data)
        return connection


class Flood(threading.Thread):
    """Writes the same again and again, faster than it can be read, until the other end has gone."""

    def __init__(self, connection, data):
        super().__init__(daemon=True)
        self.connection = connection
        self.data = data * (1 + (1 << 18) // len(data))
        self.rounds = 0
        self.start()
        wait_for(lambda: self.rounds >= 4, "somebody reads")

    def run(self):
        try:
            while True:
                self.connection.sendall(self.data)
                self.rounds += 1
        except OSError:
            pass


class Mote:
    """A mote at the end of a line, in a thread of its own.

    `answer(self, kind, seq, packet)` is called for each frame that asks to be confirmed; what it
    returns is written. All frames that came are kept, so is every byte; nothing comes malformed.
    """

    def __init__(self, test, fd, answer):
        self.fd = fd
        self.answer = answer
        self.packets = []   # Of (number, packet).
        self.others = []    # Contents of other frames.
        self.bytes = b""
        self.error = None
        self.stop, self.stopping = os.pipe()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()
        test.addCleanup(self.end)

    def run(self):
        try:
            while self.step():
                pass
        except AssertionError as error:
            self.error = error
        except OSError:  # The other end has gone.
            pass

    def step(self):
        # What came before the end is read first.
        if self.fd not in select.select([self.fd, self.stop], [], [])[0]:
            return False
        more = os.read(self.fd, 1 << 16)
        self.bytes += more
        at = self.bytes.rfind(b"\x7e") + 1
        done = len(self.packets) + len(self.others)
        for part in [part for part in self.bytes[:at].split(b"\x7e") if part][done:]:
            content = unframed(part)
            if content[0] != PACKET_ACK:
                self.others.append(content)
                continue
            self.packets.append((content[1], content[2:]))
            reply = self.answer(self, content[1], content[2:])
            if reply:
                os.write(self.fd, reply)
        return bool(more)

    def end(self):
        if self.thread.is_alive():
            os.write(self.stopping, b".")
            self.thread.join(PATIENCE_S)
        if self.stop >= 0:
            os.close(self.stop)
            os.close(self.stopping)
            self.stop = -1
        if self.error:
            raise self.error


class LiveTest(Folder):
    maxDiff = 2000
    program = Running

    def passes(self, path):
        """`rubric check` finds no fault in this file. Returns its report."""
        code, out, _ = rubric("check", path)
        self.assertEqual(code, 0, out)
        return out

    def started(self, *arguments, **more):
        running = self.program(*arguments, **more)
        self.addCleanup(running.process.stdout.close)
        self.addCleanup(running.process.stderr.close)
        if running.process.stdin:
            self.addCleanup(running.process.stdin.close)
        self.addCleanup(running.process.wait)
        self.addCleanup(running.process.kill)
        return running
