#!/usr/bin/env python3
"""A home of switches and lamps, as a network behind `rubric run proxy --network lines:HOST:PORT`.

Usage: home_lines.py [PORT]. Stands for the KNX installation of the test-bed of the paper: a
switch in a drawer, and a lamp. Says on stdout where it listens, then what the proxy asks of it;
what it reads on stdin goes to the proxy, such as `there 1/1/9 switch` or `gone 1/1/7`.
"""

import os
import select
import socket
import sys
import time

DEVICES = ("there 1/1/7 switch", "there 1/1/8 state - lamp")


class Home:
    def __init__(self, line):
        self.line = line
        self.watched = {}  # Device: when to tell, period, sensors.
        self.values = {"1/1/7": 0, "1/1/8": 0}
        for device in DEVICES:
            self.say(device)

    def say(self, line):
        self.line.sendall((line + "\n").encode())

    def asked(self, line):
        print(line, flush=True)
        word, device, *rest = line.split()
        if word == "watch":
            period = int(rest[0]) / 1000
            self.watched.pop(device, None)
            if period:
                self.watched[device] = (time.monotonic() + period, period, rest[1:])
        elif word == "command":
            self.values[device] = int(rest[0] == "on")

    def tell(self):
        """Tells what is due; returns how long nothing is."""
        now = time.monotonic()
        for device, (due, period, sensors) in list(self.watched.items()):
            if now < due:
                continue
            self.watched[device] = (due + period, period, sensors)
            for sensor in sensors:
                self.say(f"value {device} {sensor} {self.values.get(device, 0)}")
        return min((due - now for due, _, _ in self.watched.values()), default=3600)


def main(port):
    listener = socket.create_server(("127.0.0.1", port))
    print(listener.getsockname()[1], flush=True)
    line, _ = listener.accept()
    home = Home(line)
    rest = b""
    inputs = [line, sys.stdin]
    while True:
        ready = select.select(inputs, [], [], max(0, home.tell()))[0]
        if sys.stdin in ready:
            words = os.read(sys.stdin.fileno(), 4096)
            line.sendall(words)
            if not words:
                inputs.remove(sys.stdin)
        if line in ready:
            more = line.recv(4096)
            if not more:
                return
            *lines, rest = (rest + more).split(b"\n")
            for one in lines:
                home.asked(one.decode())


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 0)
