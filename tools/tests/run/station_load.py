#!/usr/bin/env python3
"""Loads a base station as 20 busy motes would: `rubric run base-station`, then the one in Java.

Usage: station_load.py RUBRIC [JAVA CLASSES] [--seconds 60] [--rate 1000]

Plays the serial forwarder of a sink. Every message asks to be acknowledged; measured is the time
from its packet to its ack. Prints one JSON object, with the ratio of both where there are two.
Exits with 0 if each message came to the application once, and every ack came, with each station.
"""

import argparse
import collections
import json
import select
import socket
import subprocess
import sys
import threading
import time

ISLAND = 11
MOTES = range(2, 22)
PC = 0xFFFD
PATIENCE_S = 30
PACKET = 122


def message(mote, number):
    """A packet from the sink: a reliable net_msg to the PC, for application 10."""
    head = bytes.fromhex("00ffff000072001c")
    addresses = b"".join(value.to_bytes(2, "big") for value in (ISLAND, PC, ISLAND, mote))
    return (head + addresses + b"\x01" + number.to_bytes(2, "big") + b"\x06\x03\x0aLOAD").ljust(
        PACKET, b"\0")


def percentile(values, part):
    return values[min(len(values) - 1, int(len(values) * part))]


class Load:
    """One station under load."""

    def __init__(self, command, event):
        self.event = event  # Returns the sender in a line of the station's output; else None.
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(PATIENCE_S)
        place = f"127.0.0.1:{self.listener.getsockname()[1]}"
        self.process = subprocess.Popen([word.replace("PLACE", place) for word in command],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.line = self.listener.accept()[0]
        self.line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self.line.recv(2) != b"U ":
            raise AssertionError("no handshake")
        self.line.sendall(b"U ")
        self.received = collections.Counter()
        self.reader = threading.Thread(target=self.read_events, daemon=True)
        self.reader.start()
        self.waiting = {}
        self.latencies = []
        self.unasked = 0
        self.bytes = b""

    def read_events(self):
        for line in self.process.stdout:
            sender = self.event(line)
            if sender is not None:
                self.received[sender] += 1

    def take(self, until):
        """Reads acks until then."""
        while True:
            left = until - time.monotonic()
            if not select.select([self.line], [], [], max(0, left))[0]:
                return
            more = self.line.recv(1 << 16)
            now = time.monotonic()
            if not more:
                raise AssertionError("the station has gone")
            self.bytes += more
            while self.bytes and len(self.bytes) > self.bytes[0]:
                size = self.bytes[0]
                self.took(self.bytes[1:1 + size], now)
                self.bytes = self.bytes[1 + size:]

    def took(self, packet, now):
        if packet[7] != 0x1C:
            return  # SET_ISLAND_ID
        at = 22 if packet[19] == 4 else 23  # An ack has one of two bodies (decision 108).
        key = (int.from_bytes(packet[10:12], "big"), int.from_bytes(packet[at:at + 2], "big"))
        sent = self.waiting.pop(key, None)
        if sent is None:
            self.unasked += 1
        else:
            self.latencies.append(now - sent)

    def run(self, rate, seconds):
        count = int(rate * seconds)
        begin = time.monotonic() + 1  # A virtual machine warms up by itself, not by traffic.
        for i in range(count):
            self.take(begin + i / rate)
            mote = MOTES[i % len(MOTES)]
            number = i // len(MOTES) % 0xFFFF
            data = message(mote, number)
            self.waiting[mote, number] = time.monotonic()
            self.line.sendall(bytes([len(data)]) + data)
        sent_s = time.monotonic() - begin
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            self.take(time.monotonic() + 0.05)
            if not self.waiting and sum(self.received.values()) >= count:
                break
        self.process.kill()
        self.process.wait()
        self.reader.join(PATIENCE_S)
        self.line.close()
        self.listener.close()
        latencies = sorted(self.latencies) or [float("inf")]
        even = len(set(self.received.values())) == 1
        return {"sent": count, "a_second": round(count / sent_s, 1), "acks": len(self.latencies),
                "unasked": self.unasked, "received": sum(self.received.values()), "even": even,
                "median_ms": round(1000 * percentile(latencies, 0.5), 3),
                "p99_ms": round(1000 * percentile(latencies, 0.99), 3),
                "max_ms": round(1000 * latencies[-1], 3)}


def of_json(line):
    event = json.loads(line)
    return event["src"] if event["event"] == "received" else None


def of_text(line):
    return line[len("received("):].split(" ")[0] if line.startswith("received(") else None


def whole(result):
    count = result["sent"]
    return (result["acks"], result["received"], result["unasked"]) == (count, count, 0) \
        and result["even"]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("rubric")
    options.add_argument("java", nargs="*")
    options.add_argument("--seconds", type=float, default=60)
    options.add_argument("--rate", type=float, default=1000)
    given = options.parse_args()
    stations = {"rubric": ([given.rubric, "run", "base-station", "--island", str(ISLAND), "--sink",
                            "sf@PLACE", "--app", "-"], of_json)}
    if given.java:
        java, classes = given.java
        stations["java"] = ([java, "-cp", classes, "rubric.basestation.ForwarderClient", "PLACE",
                             str(ISLAND)], of_text)
    results = {name: Load(*how).run(given.rate, given.seconds) for name, how in stations.items()}
    good = all(whole(result) for result in results.values())
    if given.java:
        for what in ("median_ms", "p99_ms"):
            results[f"{what}_ratio"] = round(results["rubric"][what] / results["java"][what], 2)
    print(json.dumps(results, indent=1))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
