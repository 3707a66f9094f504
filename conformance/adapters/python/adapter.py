#!/usr/bin/env python3
"""rct/1 around the mote of mote.py: reads commands, turns the clock, writes what happens."""

import sys

from mote import SETTINGS, Mote
from words import text_of


class Adapter:
    mote, now, wrote = None, 0, False

    def tx(self, line, packet):
        self.wrote = True
        print("tx", self.now, line, packet.hex())

    def up(self, name, *values):
        self.wrote = True
        print(f"up {self.now} {name}({' '.join(map(text_of, values))})")

    def answer(self, command="", *words):
        if command == "hello":
            return "hello rct/1 rubric_python_mote 1.0 roles=mote time=virtual"
        if command == "reset" and words[0] == "mote":
            settings = dict(word.split("=") for word in words[1:])
            if unknown := settings.keys() - SETTINGS:
                return f"unsupported {' '.join(sorted(unknown))}"
            self.now = 0
            self.mote = Mote(self, settings)
            return "ready"
        if not self.mote or command not in ("until", "rx", "call", "linkack", "line", "power"):
            return f"unsupported {command}"
        self.wrote = False
        self.pass_time(int(words[0]), stop_at_output=command == "until")
        if command != "until" and getattr(self.mote, command)(*words[1:]) is False:
            return f"unsupported {command} {words[1].split('(')[0]}"
        print("next", "-" if self.mote.due() is None else self.mote.due())
        return f"done {self.now}"

    def pass_time(self, end, stop_at_output):
        while (due := self.mote.due()) is not None and due <= end:
            self.now = due
            self.mote.run_due()
            if stop_at_output and self.wrote:
                return
        self.now = end


adapter = Adapter()
for line in sys.stdin:
    if line.strip() == "bye":
        break
    print(adapter.answer(*line.split()), flush=True)
