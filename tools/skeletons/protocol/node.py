#!/usr/bin/env python3
"""A node of @name@, to begin with: rct.py speaks with the test kit, and calls what is here."""

import struct

import rct

REQUEST, READING = 0xA1, 0xA2    # AM types.
DELAY = 10                       # Ticks until the answer.


class Node:
    def __init__(self, world, role, id, seed):
        self.world, self.id = world, id
        self.value = 0

    def heard(self, dest, src, am_type, payload):
        if am_type == REQUEST and dest == self.id and payload:
            self.world.tell("asked", by=src)
            self.world.after(DELAY, lambda: self.answer(src, payload[0]))

    def answer(self, dest, number):
        reading = struct.pack(">BH", number, self.value)
        self.world.transmit(dest, self.id, READING, reading)

    def sent(self, acked):
        pass    # No frame asks for the radio's acknowledgement.

    def call_measured(self, value):
        self.value = value


rct.serve(Node, "@name@_python", ["node"])
