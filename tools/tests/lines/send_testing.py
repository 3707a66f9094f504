"""Helpers of the tests of `rubric send`: packets, and their receivers."""

import json
import socket
import struct
import threading

from live_testing import Forwarder, LiveTest, Mote
from serial_testing import ACK, PATIENCE_S, Pty, hdlc
from testing import rubric

CLEAN, USAGE, INPUT, NOT_SENT, OUTPUT = 0, 64, 66, 3, 74
LONG_MS = 60_000  # Never over while somebody answers.


def config(value):
    return struct.pack(">BHHBBBBH", 0, 0xffff, 0, 3, 0, 37, 10, value)


def line(value):
    return json.dumps({"type": 10, "value": value}) + "\n"


def confirms(_, seq, __):
    return hdlc(bytes([ACK, seq]))


def send(*arguments, text="", env=None):
    """Exit code, stdout, stderr."""
    return rubric("send", *arguments, stdin=text, env=env)


class Base(LiveTest):
    def mote(self, answer):
        """Returns an address, and the mote there."""
        device = Pty(self)
        return f"serial@{device.name}:telosb", Mote(self, device.fd, answer)

    def forwarder(self, serve, receive_bytes=None):
        """Returns an address; `serve(connection)` runs in a thread. Its socket's buffer is small
        if receive_bytes is given."""
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
