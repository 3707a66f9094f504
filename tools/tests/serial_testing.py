"""Helpers of the tests of serial lines: frames, the far end of a line, ports, and patience."""

import contextlib
import os
import pathlib
import pty
import select
import signal
import socket
import time
import tty

PATIENCE_S = 60
# Tests end programs by SIGINT. A shell ignores it in what it starts with '&', and so would they.
signal.signal(signal.SIGINT, signal.default_int_handler)
ACK, PACKET_ACK, PACKET_NOACK, UNKNOWN = 0x43, 0x44, 0x45, 0xff


@contextlib.contextmanager
def held_port():
    """A port of ours: bound, so that nobody else gets it, but a listener that reuses may listen."""
    with socket.socket() as holder:
        holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        holder.bind(("127.0.0.1", 0))
        yield holder.getsockname()[1]


def crc(data):
    value = 0
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ 0x1021 if value & 0x8000 else value << 1) & 0xffff
    return value


def hdlc(content, wrong=0):
    whole = content + (crc(content) ^ wrong).to_bytes(2, "little")
    out = b"".join(bytes([0x7d, byte ^ 0x20]) if byte in (0x7d, 0x7e) else bytes([byte])
                   for byte in whole)
    return b"\x7e" + out + b"\x7e"


def unframed(part):
    """The content of what stood between two flags; a malformed one raises AssertionError."""
    out, escaped = bytearray(), False
    for byte in part:
        if byte == 0x7d:
            escaped = True
        else:
            out.append(byte ^ 0x20 if escaped else byte)
            escaped = False
    content, check = bytes(out[:-2]), bytes(out[-2:])
    if escaped or crc(content).to_bytes(2, "little") != check:
        raise AssertionError(f"a malformed frame: {part.hex()}")
    return content


def wait_for(holds, what):
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        if time.monotonic() > deadline:
            raise AssertionError(f"waited in vain until {what}")
        time.sleep(0.02)


def read_until(fd, enough, got=b""):
    """Reads until `enough` holds of all bytes, or none come. Returns them, and whether it holds."""
    deadline = time.monotonic() + PATIENCE_S
    while not enough(got):
        ready = select.select([fd], [], [], max(0, deadline - time.monotonic()))[0]
        more = os.read(fd, 1 << 16) if ready else b""
        if not more:
            return got, False
        got += more
    return got, True


def holds(process, path):
    """Returns whether it has the file open."""
    def is_it(descriptor):
        try:
            return os.readlink(descriptor) == os.path.realpath(path)
        except FileNotFoundError:  # Closed since it was listed.
            return False
    return any(map(is_it, pathlib.Path(f"/proc/{process.pid}/fd").iterdir()))


class Pty:
    """A serial device whose other end is here."""

    def __init__(self, test):
        self.fd, other = pty.openpty()
        tty.setraw(self.fd)
        self.name = os.ttyname(other)
        test.addCleanup(self.close)
        test.addCleanup(os.close, other)

    def read(self, seconds):
        """Returns the bytes of that time."""
        got = b""
        deadline = time.monotonic() + seconds
        while select.select([self.fd], [], [], max(0, deadline - time.monotonic()))[0]:
            got += os.read(self.fd, 1000)
        return got

    def opened(self, process):
        """Waits until the process listens: opening it throws away what came before."""
        wait_for(lambda: holds(process, self.name), f"{self.name} is opened")
        time.sleep(0.2)

    def take(self, size):
        """So many bytes at least, if they come."""
        got = b""
        while len(got) < size and select.select([self.fd], [], [], PATIENCE_S)[0]:
            got += os.read(self.fd, 1000)
        return got

    def close(self):
        """Unplugged."""
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1
