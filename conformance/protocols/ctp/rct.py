"""rct/1 for a node in Python: reads commands, turns the clock, writes what happens.

A node is a class, made with its World, its role, and by name its TinyOS id, a seed, and those of
the protocol's parameters with which it can be built:

    node.heard(dest, src, am_type, payload)    a frame came by radio, whoever it is for
    node.sent(acked)                           a frame of its own that asked for an ack is over
    node.call_NAME(**arguments)                its application calls NAME
"""

import heapq
import itertools
import struct
import sys

BROADCAST = 0xFFFF
HEADER = struct.Struct(">BHHBBB")    # Dispatch, destination, source, length, group, type.


class World:
    """What is around a node: a clock of 1024 ticks to the second, a radio, an application."""

    def __init__(self):
        self.now, self.wrote = 0, False
        self.timers, self.numbers = [], itertools.count()

    def after(self, ticks, action):
        """Runs `action` so much later; returns what cancel() takes."""
        timer = [self.now + ticks, next(self.numbers), action]
        heapq.heappush(self.timers, timer)
        return timer

    def cancel(self, timer):
        if timer:
            timer[2] = None

    def transmit(self, dest, src, am_type, payload, ack=False):
        packet = HEADER.pack(0, dest, src, len(payload), 0, am_type) + payload
        print("tx", self.now, "radio", packet.hex(), *(["linkack"] if ack else []))
        self.wrote = True

    def tell(self, event, **values):
        """Tells the application."""
        named = " ".join(f"{name}={text_of(value)}" for name, value in values.items())
        print(f"up {self.now} {event}({named})")
        self.wrote = True

    def due(self):
        while self.timers and not self.timers[0][2]:
            heapq.heappop(self.timers)
        return self.timers[0][0] if self.timers else None

    def pass_time(self, end, stop_at_output):
        while (due := self.due()) is not None and due <= end:
            if stop_at_output and self.wrote and due > self.now:
                return
            self.now = due
            heapq.heappop(self.timers)[2]()
        if not (stop_at_output and self.wrote):
            self.now = end


def text_of(value):
    return "x" + value.hex() if isinstance(value, bytes) else str(int(value))


def value_of(text):
    return bytes.fromhex(text[1:]) if text.startswith("x") else int(text)


class Adapter:
    def __init__(self, make, name, roles, parameters):
        self.make, self.roles, self.parameters = make, roles, parameters
        self.greeting = f"hello rct/1 {name} 1.0 roles={','.join(roles)} time=virtual"
        self.world = self.node = self.start = None

    def reset(self, role, *words):
        wanted = {name: int(value) for name, _, value in (word.partition("=") for word in words)}
        if unknown := set(wanted) - {"id", "seed"} - set(self.parameters):
            return f"unsupported {' '.join(sorted(unknown))}"
        if role not in self.roles:
            return f"unsupported {role}"
        self.world = World()
        settings = {"id": 0, "seed": 0, **self.parameters, **wanted}
        self.start = lambda: self.make(self.world, role, **settings)
        self.node = self.start()
        return "ready"

    def rx(self, link, packet):
        _, dest, src, size, _, am_type = HEADER.unpack_from(bytes.fromhex(packet))
        if link == "radio" and self.node:
            self.node.heard(dest, src, am_type, bytes.fromhex(packet)[HEADER.size:][:size])

    def linkack(self, acked):
        if self.node:
            self.node.sent(acked == "1")

    def call(self, *words):
        name, _, arguments = " ".join(words).rstrip(")").partition("(")
        called = getattr(self.node, "call_" + name, None)
        if self.node and not called:
            return f"unsupported call {name}"
        if called:
            named = (argument.split("=") for argument in arguments.split())
            called(**{key: value_of(value) for key, value in named})
        return None

    def power(self, state):
        self.world.timers.clear()
        self.node = self.start() if state == "reboot" else None

    def answer(self, command="", *words):
        if command == "hello":
            return self.greeting
        if command == "reset" and words:
            return self.reset(*words)
        if not self.world or command not in ("until", "rx", "call", "linkack", "power"):
            return f"unsupported {command}"
        self.world.wrote = False
        self.world.pass_time(int(words[0]), stop_at_output=command == "until")
        if command != "until" and (refused := getattr(self, command)(*words[1:])):
            return refused
        due = self.world.due()
        print("next", "-" if due is None else due)
        return f"done {self.world.now}"


def serve(make, name, roles, **parameters):
    """Answers rct/1 on standard input until `bye`. `parameters` have the values that app.yaml has
    for a node that states none."""
    adapter = Adapter(make, name, roles, parameters)
    for line in sys.stdin:
        if line.strip() == "bye":
            break
        print(adapter.answer(*line.split()), flush=True)
