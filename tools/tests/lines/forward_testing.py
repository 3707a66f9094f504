"""Helpers of the tests of `rubric forward`: a serial line's far end, and a client.

Written from the protocols, without code of the program: Debian has no client of TinyOS's Serial
Forwarder.
"""

import os
import pty
import re
import resource
import select
import signal
import socket
import subprocess
import threading
import tty

from serial_testing import PATIENCE_S, hdlc, unframed
from testing import RUBRIC, sanitized

# Sanitizers open pipes to see whether memory can be read: without descriptors they see faults.
SANITIZED = sanitized()


def packet(number, size=20):
    """An AM packet of that many bytes of payload, with its number in it."""
    return bytes([0, 0xff, 0xff, 0, 0, size, 0, 6]) + number.to_bytes(4, "big") * (size // 4)


def from_mote(data):
    return hdlc(b"\x45" + data)


class Running:
    """A forwarder, until the end of the test; `limits` is what the shell does before."""

    def __init__(self, test, source, *arguments, port=0, limits=":"):
        self.process = subprocess.Popen(
            ["sh", "-c", limits + '; exec "$@"', "sh",
             RUBRIC, "forward", source, "--port", str(port), *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        test.addCleanup(self.close)
        self.complaints = []
        self.said = threading.Condition()
        self.reader = threading.Thread(target=self.listen, daemon=True)
        self.reader.start()
        line = self.process.stdout.readline()
        found = re.fullmatch(r"listening on (\[[0-9a-f:]+\]|[0-9.]+):(\d+)\n", line)
        if not found:
            raise AssertionError(f"'{line}', then {self.end(None)}")
        self.host = found[1].strip("[]")
        self.port = int(found[2])

    def listen(self):
        for line in self.process.stderr:
            with self.said:
                self.complaints.append(line.rstrip("\n"))
                self.said.notify_all()

    def wait_for(self, pattern):
        """Until it has said so on stderr."""
        def found():
            return next((line for line in self.complaints if re.search(pattern, line)), None)
        with self.said:
            if not self.said.wait_for(found, PATIENCE_S):
                raise AssertionError(f"no '{pattern}' in {self.complaints}")
            return found()

    def end(self, signal_number=signal.SIGINT):
        """Exit code and the summary; `cpu_seconds` then says what it all took."""
        if signal_number is not None:
            self.process.send_signal(signal_number)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        code = self.process.wait(PATIENCE_S)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.cpu_seconds = sum(after[:2]) - sum(before[:2])
        self.reader.join(PATIENCE_S)
        return code, self.complaints[-1] if self.complaints else ""

    def close(self):
        self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()
        self.process.stderr.close()


class Client:
    """A serial forwarder's client: 'U ' both ways, then a length byte and that many bytes."""

    def __init__(self, test, running, hello=b"U ", receive_bytes=None):
        family = socket.AF_INET6 if ":" in running.host else socket.AF_INET
        self.socket = socket.socket(family)
        test.addCleanup(self.socket.close)
        if receive_bytes:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect((running.host, running.port))
        # Otherwise a small packet stays here until the one before it is confirmed.
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.read = b""
        self.name = "{}:{}".format(*self.socket.getsockname()[:2])
        if hello is not None:
            self.socket.sendall(hello)
        test.assertEqual(self.take(2), b"U ")

    def take(self, size):
        while len(self.read) < size:
            more = self.socket.recv(1 << 16)
            if not more:
                raise EOFError(f"{len(self.read)} of {size} bytes")
            self.read += more
        out, self.read = self.read[:size], self.read[size:]
        return out

    def packet(self):
        return self.take(self.take(1)[0])

    def packets(self, count):
        return [self.packet() for _ in range(count)]

    def give(self, data):
        self.socket.sendall(bytes([len(data)]) + data)

    def wait_until_cut_off(self):
        """Reads to the end; an error where that does not come."""
        try:
            while self.socket.recv(1 << 16):
                pass
        except ConnectionResetError:
            pass


class Mote:
    """The far end of a serial line: of a pseudo terminal, or of a TCP port that carries one."""

    def __init__(self, test):
        self.read = b""
        self.listener = self.connection = None
        self.test = test

    def on_a_terminal(self):
        master, slave = pty.openpty()
        tty.setraw(master)
        self.connection = os.fdopen(master, "r+b", buffering=0)
        self.test.addCleanup(self.connection.close)
        self.source = f"serial@{os.ttyname(slave)}:telosb"
        self.test.addCleanup(os.close, slave)
        return self

    def on_a_port(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(PATIENCE_S)
        self.test.addCleanup(self.listener.close)
        self.source = "network@127.0.0.1:{}".format(self.listener.getsockname()[1])
        return self

    def accept(self):
        connection, _ = self.listener.accept()
        connection.settimeout(PATIENCE_S)
        self.connection = connection.makefile("rwb", buffering=0)
        self.test.addCleanup(self.connection.close)
        connection.close()  # The file has it.
        self.read = b""
        return self

    def say(self, data):
        left = memoryview(data)
        while left:
            left = left[self.connection.write(left):]

    def frame(self):
        """The next frame that the host sends, from its kind on, without the CRC."""
        while True:
            match = re.search(rb"\x7e([^\x7e]+)\x7e", self.read)
            if match:
                self.read = self.read[match.end():]
                return unframed(match[1])
            if not select.select([self.connection], [], [], PATIENCE_S)[0]:
                raise AssertionError("the host sends nothing")
            more = self.connection.read(1000)
            if not more:
                raise EOFError
            self.read += more

    def confirmed_packet(self):
        """The next packet of the host, confirmed."""
        content = self.frame()
        self.test.assertEqual(content[0], 0x44)
        self.say(hdlc(bytes([0x43, content[1]])))
        return content[2:]


def serving(test, *arguments, terminal=False, **more):
    """A mote, and a forwarder of its line."""
    mote = Mote(test).on_a_terminal() if terminal else Mote(test).on_a_port()
    running = Running(test, mote.source, *arguments, **more)
    return mote if terminal else mote.accept(), running
