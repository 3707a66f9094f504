"""Helpers of the tests of `rubric check` on growing runs: captures, and a reader of findings."""

import json
import os
import pathlib
import signal
import struct
import time

import live_testing
from live_testing import Forwarder
from serial_testing import PATIENCE_S, hdlc, read_until
from testing import ROOT, rubric

CAPTURES = pathlib.Path("spec/captures")
BROKEN_LINE = CAPTURES / "basestation/s06_control_03.from_sink.sfstream"  # J6-CONTENT fails.
CLEAN_LINE = CAPTURES / "firmware/a_join_data.serial.bin"
OPEN_LINE = CAPTURES / "firmware/b_reliable.serial.bin"  # Stays inconclusive.
STRAY_REPLY = CAPTURES / "firmware/g2_stray_reply_while_joining.pcapng"  # J4-SEQ fails.
MANY = CAPTURES / "firmware/a2_join_data_sensible_start.pcapng"  # J3-TIME fails.
SERIAL_TOO = CAPTURES / "firmware/c_two_islands.pcapng"  # Weak.
TWO_TAPS = CAPTURES / "firmware/e1_simultaneous_join.pcapng"
PACKET_BLOCK = 6


def data(path):
    return (ROOT / path).read_bytes()


def blocks(capture):
    """The blocks of a little-endian pcapng file."""
    at = 0
    while at < len(capture):
        size = struct.unpack_from("<I", capture, at + 4)[0]
        yield capture[at:at + size]
        at += size


def is_packet(block):
    return struct.unpack_from("<I", block)[0] == PACKET_BLOCK


def until_packet(capture, count):
    """Returns the size in bytes of a capture up to that packet, included."""
    size = 0
    for block in blocks(capture):
        size += len(block)
        count -= is_packet(block)
        if count == 0:
            break
    return size


def stamped(block, shift_us):
    """A packet block of microseconds, that much later."""
    ticks = (struct.unpack_from("<I", block, 12)[0] << 32) + struct.unpack_from("<I", block, 16)[0]
    ticks += shift_us
    return block[:12] + struct.pack("<II", ticks >> 32, ticks & 0xffffffff) + block[20:]


class Checked(live_testing.Running):
    """A `rubric check` that somebody waits for."""

    def __init__(self, *arguments, **more):
        super().__init__("check", *arguments, **more)
        self.seen = []

    def event(self, kind, requirement=None):
        """The next event of that kind; those before it are in `seen`."""
        while True:
            self.seen += self.lines(1)
            event = self.seen[-1]
            if event["event"] != kind:
                continue
            if requirement is None or event["finding"]["requirement"] == requirement:
                return event

    def text(self, wanted, stream=None):
        """Returns the output up to that text."""
        got, came = read_until((stream or self.process.stdout).fileno(),
                               lambda got: wanted.encode() in got)
        if not came:
            self.process.kill()
            raise AssertionError(f"no {wanted!r} in {got}: {self.end(None)}")
        return got.decode()

    def report(self, signal_number=signal.SIGINT):
        """Exit code, the last event's report, and what was said on stderr."""
        code, out, err = self.end(signal_number)
        self.seen += [json.loads(line) for line in (self.read.decode() + out).splitlines()]
        if self.seen[-1]["event"] != "report":
            raise AssertionError(f"{code}, {self.seen[-1]}, {err}")
        report = self.seen[-1]["report"]
        told, reported = standing(self.seen), of_findings(report["findings"])
        if not told.items() <= reported.items():
            raise AssertionError(f"told {told}, reported {reported}")
        return code, report, err


def offline(*arguments):
    code, out, err = rubric("check", *arguments, "--format", "json", cwd=ROOT)
    return code, json.loads(out) if out else err


def frames_in(path):
    """Returns how many frames a capture holds: none while it is not there, or only begun."""
    report = offline(path)[1]
    return report["counts"]["frames"] if isinstance(report, dict) else 0


def key(finding):
    return finding["file"], finding["frame"], finding["requirement"], finding["node"]


def of_findings(findings):
    return {key(finding): finding["severity"] for finding in findings}


def standing(events):
    """Returns the findings that were reported and not withdrawn."""
    out = {}
    for event in events:
        if event["event"] in ("found", "changed"):
            out[key(event["finding"])] = event["finding"]["severity"]
        elif event["event"] == "withdrawn":
            del out[key(event["finding"])]
    return out


class CheckTest(live_testing.LiveTest):
    maxDiff = 3000
    program = Checked

    def served(self, content, *arguments):
        """A check of a serial forwarder that sends this and stays open."""
        server = Forwarder(self)
        running = self.started(f"sf@127.0.0.1:{server.port}", *arguments)
        connection = server.accept(content)
        return running, connection

    def opened(self, running, line):
        """Waits for the line to be listened to: opening it throws away what came before."""
        deadline = time.monotonic() + PATIENCE_S
        ask = hdlc(b"\x44\x2a" + bytes.fromhex("00ffff000001002509"))
        while True:
            os.write(line.fd, ask)
            if line.read(0.2):
                break
            self.assertLess(time.monotonic(), deadline, running.process.poll())
