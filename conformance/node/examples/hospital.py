#!/usr/bin/env python3
"""Channels that a base station sets up, as in the paper's listing of the in-hospital test-bed:
`rubric run islands.yaml` runs this as the application of all nodes of an island.

hospital.py base   the base station: makes each mote that joins open a channel to the sink, sets
                   the clock, starts the channel, and says on stderr what the sink reads
hospital.py sink   the sink: ends the channels, and sends what comes through to the base station
hospital.py mote   a mote: joins, and sends a slow wave through its channel

The commands are the Learning Layer's messages syn_create_cmd, broadcast_cmd and netid_cmd, of which
the Communication Layer knows no more than that they arrive; what they do is said here.
"""

import collections
import json
import math
import struct
import sys
import threading
import time

SINK, LEARNING = 1, 6
START, STOP, CLOCK, OUTGOING, INCOMING, ANSWER, OUTPUT = 1, 2, 8, 9, 10, 23, 25
JOINED = 16  # What a sink reports of a new mote.
RESULTS = ("channel_result", "op_result", "send_result", "input_value")


class Node:
    """Results come in the order of the calls."""

    def __init__(self):
        self.waiting = collections.deque()
        self.lock = threading.Lock()

    def call(self, then=lambda result: None, **what):
        with self.lock:
            if what["call"] != "join":
                self.waiting.append(then)
            print(json.dumps(what), flush=True)

    def send(self, dest, data, reliable=True):
        self.call(call="send", dest=dest, app_id=LEARNING, reliable=reliable, data=data.hex())

    def take(self, event):
        if event["event"] in RESULTS:
            self.waiting.popleft()(event)
        else:
            self.happened(event)


class Base(Node):
    """Gives one command after the other, each again until it has arrived."""

    def __init__(self):
        super().__init__()
        self.commands = collections.deque()
        self.number = 0

    def happened(self, event):
        data = bytes.fromhex(event.get("data", ""))
        if event["event"] == "ack_received" and not event["success"]:
            self.go_on()
        elif event["event"] != "received":
            return
        elif data[0] == JOINED:
            self.set_up(*struct.unpack_from(">HH", data, 1))
        elif data[0] == ANSWER and struct.unpack_from(">H", data, 1)[0] == self.number:
            if data[3]:
                print(f"{event['src']} refuses", file=sys.stderr, flush=True)
            self.commands.popleft()
            self.number += 1
            self.go_on()
        elif data[0] == OUTPUT:
            values = struct.unpack_from(f"<{data[1]}f", data, 2)
            print("the sink reads", *(f"{value:.2f}" for value in values), file=sys.stderr,
                  flush=True)

    def set_up(self, island, mote):
        idle = not self.commands
        ends = (island, mote, island, SINK, 0, 0)
        neurons = (1, *[0] * 10)
        for dest, kind in ((f"{island}:{SINK}", INCOMING), (f"{island}:{mote}", OUTGOING)):
            create = struct.pack(">B6HB10HB10Hb", kind, *ends, *neurons, *neurons, 0)
            for command in (create, struct.pack(">BH", CLOCK, 500), struct.pack(">BH", START, 0)):
                self.commands.append((dest, command))
        if idle:
            self.go_on()

    def go_on(self):
        if self.commands:
            dest, command = self.commands[0]
            self.send(dest, command + struct.pack(">H", self.number))


class Learner(Node):
    """Does what the base station commands, and answers whether it could."""

    def __init__(self):
        super().__init__()
        self.base = None
        self.answers = {}
        self.last = None

    def happened(self, event):
        if event["event"] == "ack_received" and not event["success"]:
            self.answer(self.last)
        elif event["event"] == "received" and event["app_id"] == LEARNING:
            self.base = event["src"]
            data = bytes.fromhex(event["data"])
            number, = struct.unpack(">H", data[-2:])
            if number not in self.answers:
                self.answers[number] = b""
                self.obey(data, lambda result: self.done(number, result))
            elif self.answers[number]:  # The base station does not know that it has arrived.
                self.answer(number)

    def obey(self, data, done):
        if data[0] in (OUTGOING, INCOMING):
            src_island, src, dest_island, dest = struct.unpack_from(">4H", data, 1)
            if data[0] == OUTGOING:
                end = {"call": "create_out", "dest": f"{dest_island}:{dest}", "size": data[13]}
            else:
                end = {"call": "create_in", "src": f"{src_island}:{src}", "size": data[34]}
            self.call(done, **end, power_save=bool(data[55]))
        elif data[0] == CLOCK:
            milliseconds, = struct.unpack_from(">H", data, 1)
            self.call(done, call="set_time_step", clock=milliseconds * 1024 // 1000)
        elif data[0] in (START, STOP):
            self.call(done, call="start_all" if data[0] == START else "stop_all")

    def done(self, number, result):
        self.answers[number] = struct.pack(">BHB", ANSWER, number, not result["success"])
        self.answer(number)
        if result["event"] == "channel_result" and result["success"]:
            self.created(result["channel"])

    def answer(self, number):
        self.last = number
        self.send(self.base, self.answers[number])


class Sink(Learner):
    """Reads what comes, and sends it on."""

    def __init__(self):
        super().__init__()
        self.values = {}

    def created(self, channel):
        self.values[channel] = 0.0

    def happened(self, event):
        super().happened(event)
        if event["event"] == "syn_data" and event["status"] == "new":
            channel = event["channel"]
            self.call(lambda result: self.read(channel, result["value"]), call="read_input",
                      channel=channel, pos=0)

    def read(self, channel, value):
        self.values[channel] = value
        values = struct.pack(f"<{len(self.values)}f", *self.values.values()).ljust(96, b"\0")
        self.send(self.base, bytes([OUTPUT, len(self.values)]) + values, reliable=False)


class Mote(Learner):
    """Joins, and sends a wave."""

    def __init__(self):
        super().__init__()
        self.call(call="join", type=1, transducers=0, actuators=0)

    def happened(self, event):
        super().happened(event)
        if event["event"] == "joined" and not event["success"]:
            self.call(call="join", type=1, transducers=0, actuators=0)

    def created(self, channel):
        threading.Thread(target=self.wave, args=(channel,), daemon=True).start()

    def wave(self, channel):
        while True:
            self.call(call="write_output", channel=channel, pos=0, value=math.sin(time.time()))
            time.sleep(0.25)


node = {"base": Base, "sink": Sink, "mote": Mote}[sys.argv[1]]()
for line in sys.stdin:
    node.take(json.loads(line))
