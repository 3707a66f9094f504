#!/usr/bin/env python3
"""rct/1 around the mote of mote.py: reads commands, drives the mote, writes what happens."""

import sys

from mote import Address, ChannelId, Mote


def value_of(text):
    if text.startswith("x"):
        return bytes.fromhex(text[1:])
    for mark, kind in (("->", ChannelId), (":", Address)):
        if mark in text:
            return kind(*map(int, text.split(mark)))
    return int(text) if text.isdigit() else float(text)


def text_of(value):
    if isinstance(value, bytes):
        return "x" + value.hex()
    return str(int(value) if isinstance(value, bool) else value)


class Unsupported(Exception):
    """What this implementation cannot do: the case is skipped, and that is shown."""


class Adapter:
    settings = mote = None

    # What the mote does to its world.

    def tx(self, line, packet):
        self.write("tx", self.now, line, packet.hex())

    def up(self, name, *values):
        self.write("up", self.now, f"{name}({' '.join(map(text_of, values))})")

    def write(self, *words):
        self.wrote = True
        print(*words)

    # What the runner asks for. The answer is the closing line.

    def answer(self, command="", *words):
        if command == "hello":
            return "hello rct/1 rubric_python_mote 1.0 roles=mote time=virtual"
        if command == "reset":
            return self.reset(*words)
        action = getattr(self, "on_" + command, None)
        if not action or not self.settings:
            raise Unsupported(f"command {command}")
        self.wrote = False
        self.pass_time(int(words[0]), command == "until")
        if self.mote or command == "power":
            action(*words[1:])
        due = self.due()
        print("next", "-" if due is None else due)
        return f"done {self.now}"

    def reset(self, role, *arguments):
        if role != "mote":
            raise Unsupported(f"role {role}")
        self.settings = dict(argument.split("=") for argument in arguments)
        self.now, self.number = 0, (1000 + 257 * int(self.settings["seed"])) & 0xFFFF
        self.start()
        return "ready"

    def start(self):
        self.mote = Mote(self, int(self.settings["id"]), int(self.settings["channels"]),
                         self.number, self.now)

    def due(self):
        return self.mote.due() if self.mote else None

    def pass_time(self, until, stop_at_output):
        while not (stop_at_output and self.wrote):
            due = self.due()
            if due is None or due > until:
                self.set_time(until)
                return
            self.set_time(due)
            self.mote.run_due()

    def set_time(self, now):
        self.now = now
        if self.mote:
            self.mote.now = now

    def on_until(self):
        pass

    def on_rx(self, line, packet):
        self.mote.heard(line, bytes.fromhex(packet))

    def on_call(self, *words):
        name, _, arguments = " ".join(words).rstrip(")").partition("(")
        call = getattr(self.mote, "call_" + name, None)
        if not call:
            raise Unsupported(f"call {name}")
        named = (argument.split("=") for argument in arguments.split())
        call(**{key: value_of(value) for key, value in named})

    def on_line(self, line, state):
        self.mote.set_busy(line, state == "busy")

    def on_linkack(self, acked):
        pass    # It never asks for one.

    def on_power(self, what):
        if self.mote:
            self.number = self.mote.number    # All that outlives a loss of power.
        self.mote = None
        if what == "reboot":
            self.start()


def main():
    adapter = Adapter()
    for line in sys.stdin:
        words = line.split()
        if words == ["bye"]:
            return
        try:
            print(adapter.answer(*words), flush=True)
        except Unsupported as why:
            print(f"unsupported {why}", flush=True)


if __name__ == "__main__":
    main()
