"""What the tests of `rubric send` share: packets, and who gets them."""

import json
import os
import socket
import struct
import subprocess
import threading

from live_testing import RUBRIC, Forwarder, LiveTest, Mote
from serial_testing import ACK, PATIENCE_S, Pty, hdlc

CLEAN, USAGE, INPUT, NOT_SENT = 0, 2, 3, 4
LONG_MS = 60_000  # Never over while somebody answers.


def config(value):
    return struct.pack(">BHHBBBBH", 0, 0xffff, 0, 3, 0, 37, 10, value)


def line(value):
    return json.dumps({"type": 10, "value": value}) + "\n"


def confirms(_, seq, __):
    return hdlc(bytes([ACK, seq]))


def send(*arguments, text="", env=None):
    """Exit code, stdout, stderr."""
    done = subprocess.run([RUBRIC, "send", *map(str, arguments)], input=text, text=True,
                          capture_output=True, check=False, env={**os.environ, **(env or {})},
                          timeout=3 * PATIENCE_S)
    return done.returncode, done.stdout, done.stderr


class Base(LiveTest):
    def mote(self, answer):
        """Where to send, and the mote there."""
        device = Pty(self)
        return f"serial@{device.name}:telosb", Mote(self, device.fd, answer)

    def forwarder(self, serve, receive_bytes=None):
        """Where to send; `serve(connection)` runs in a thread. There is little room for what comes
        where it has receive_bytes."""
        server = Forwarder(self)
        if receive_bytes:
            server.listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)

        def run():
            with server.accept(b"U ") as connection:
                serve(connection)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        self.addCleanup(thread.join, PATIENCE_S)
        return f"sf@127.0.0.1:{server.port}", thread
