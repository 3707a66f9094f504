#!/usr/bin/env python3
"""A sink in QEMU, seen through its serial line alone, as a base station has it.

Usage: arm_serial_test.py FIRMWARE_ARM SINK_ELF [RUBRIC]: a talk with it by both ways to the line,
or the suite over TCP.
"""

import collections
import concurrent.futures
import functools
import json
import os
import pathlib
import select
import socket
import struct
import subprocess
import sys
import termios
import time
import tty

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools/tests"))

# pylint: disable-next=wrong-import-position
from serial_testing import ACK, PACKET_ACK, PACKET_NOACK, hdlc, unframed

PATIENCE_S = 20  # For a machine that is busy with other tests.
AGAIN_S = 1
PARTS = 4     # Of the suite; each waits most of the time.
CONNLESS, MOCKUP, RUBICON_ACK = 3, 5, 9
PC = 0xFFFD


def contents(stream):
    """Returns the intact frames in `stream`."""
    for part in stream.split(b"\x7e"):
        try:
            content = unframed(part)
        except AssertionError:
            continue
        if len(content) >= 2:
            yield content


def net_packet(dest, src, reliable, seq, body):
    net = struct.pack(">HHHHBHB", *dest, *src, reliable, seq, len(body)) + body
    return struct.pack(">BHHBBB", 0, 1, 0, len(net), 0, 28) + net


def ask(line, question, wanted):
    """The first content that `wanted` accepts. Asks again as TinyOS's hosts do: a node that has no
    room for a frame does not confirm it."""
    stream, end = b"", time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        os.write(line, question)
        again = time.monotonic() + AGAIN_S
        while time.monotonic() < again:
            if select.select([line], [], [], 0.1)[0]:
                stream += os.read(line, 4096)
            for content in contents(stream):
                if wanted(content):
                    return content
    raise SystemExit(f"not heard: {wanted.__doc__}; but {stream.hex()}")


def is_confirmation(content):
    """the confirmation of the packet"""
    return content == bytes([ACK, 14])


def is_rubicon_ack(content):
    """the rubicon ack of the message"""
    if content[0] != PACKET_NOACK or len(content) != 1 + 8 + 114:
        return False
    net = content[9:]
    dest, src, body = struct.unpack(">HH", net[:4]), struct.unpack(">HH", net[4:8]), net[12:]
    return dest == (12, PC) and src == (12, 1) and body[0] == RUBICON_ACK and body[1] == MOCKUP \
        and struct.unpack(">H", body[3:5]) == (77,)


def talk(line):
    """A new island id, and a reliable message that is acked from there."""
    config = struct.pack(">BHHBBBBH", 0, 1, 0, 3, 0, 37, 10, 12)
    os.write(line, hdlc(bytes([PACKET_NOACK]) + config))
    message = net_packet((12, 1), (12, PC), 1, 77, bytes([CONNLESS, MOCKUP, 0x7E, 0x7D]))
    os.write(line, hdlc(bytes([PACKET_NOACK]) + message[:-1]))  # Cut short, so dropped.
    ask(line, hdlc(bytes([PACKET_ACK, 14]) + message), is_confirmation)
    # The ack may have come in one piece with the confirmation, so it is asked for once more.
    ask(line, hdlc(bytes([PACKET_ACK, 15]) + message), is_rubicon_ack)


def work_suite(rubric, device, part, cases):
    """A part of the cases at a sink of its own, without those that last minutes."""
    done = subprocess.run([rubric, "test", "--target", f"serial:{device}", "--role", "sink",
                           "--except", "many.*", "--shard", part, "--format", "json"],
                          capture_output=True, text=True)
    cases.extend(case for run in json.loads(done.stdout)["implementations"]
                 for case in run["cases"])
    if done.returncode != 0:
        raise SystemExit(f"rubric test --shard {part}: {done.returncode}")


def serve_suite(rubric):
    """Rules that the line alone can show are kept; the rest is undecided."""
    cases = []
    with concurrent.futures.ThreadPoolExecutor(max_workers=PARTS) as parts:
        runs = [parts.submit(serve, "--serial-tcp", functools.partial(
            work_suite, rubric, part=f"{i}/{PARTS}", cases=cases)) for i in range(1, PARTS + 1)]
    verdicts = collections.Counter(case["verdict"] for case in cases)
    print(f"rubric test: {dict(verdicts)}")
    for case in cases:
        for failure in case["failures"] if case["verdict"] in ("fail", "error") else []:
            print(f"{case['name']}: {failure}")
    for run in runs:
        run.result()
    if verdicts["pass"] < 2:
        raise SystemExit("the suite decides nothing")


def over_device(name):
    line = os.open(name, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(line, termios.TCSANOW)
    talk(line)
    os.close(line)


def over_tcp(name):
    """Twice, since users of a line come and go."""
    kind, host, port = name.split(":")
    if kind != "tcp":
        raise SystemExit(f"{name} is not as in serial:tcp:HOST:PORT")
    for _ in range(2):
        with socket.create_connection((host, int(port)), PATIENCE_S) as line:
            talk(line.fileno())


def serve(option, use):
    """Calls `use` with what a sink in QEMU says its line is called."""
    program = subprocess.Popen([sys.argv[1], option, "11", sys.argv[2]],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        name = program.stdout.readline().strip()
        if not name:
            raise SystemExit(f"{option} names no line")
        use(name)
        print(f"{name}: as it should be")
    finally:
        program.stdin.close()
        program.wait(PATIENCE_S)
    if program.returncode != 0:
        raise SystemExit(f"{option} ended with {program.returncode}")


def main():
    if len(sys.argv) > 3:
        serve_suite(sys.argv[3])
    else:
        serve("--serial-device", over_device)
        serve("--serial-tcp", over_tcp)


if __name__ == "__main__":
    main()
