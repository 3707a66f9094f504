"""A small mote of the RUBICON Communication Layer: joining, network, transport, synaptic channels.

It has no thread, and no clock but its world's. Whoever drives it gives it what happens, and calls
run_due() when due() says so. Where the rules leave a choice it takes another one than the reference
machine does; the decisions are named.
"""

import collections
import struct
from typing import NamedTuple

from words import Address, ChannelId, call_of

JOIN, JOIN_REPLY, NET, ACK_JOIN = 14, 15, 28, 29              # AM types.
SYN_CHANNEL, CONNLESS, LEARNING, RUBICON_ACK = 1, 3, 6, 9     # TRANSID and APPID.
APPLICATIONS = (5, LEARNING, 10)                              # MOCKUP and CONTROL_LAYER.
ALL, LOCAL, NULL = 0xFFFF, 0xFFFE, 0xFFFD                     # Reserved islands and devices.
SINK_AM = 1
REFUSED = 0xFFFF
NEW, OLD, UNKNOWN_CHANNEL = 0, 1, 2

# What a mote can be built with; it sends one ack_join, so it keeps any number of these.
SETTINGS = {"id", "island", "channels", "seed", "profile", "join_requests", "ack_joins"}
REQUESTS = 4             # The letter of "fires for four times" (decision 101).
JOIN_PERIOD = 500
ACK_TIMEOUT = 1000
BUFFER = 4
DATA_MAX = 100
CONNECTIONS_MAX = 10


class Message(NamedTuple):
    dest: Address
    src: Address
    reliable: int
    number: int
    transport: int
    application: int
    data: bytes


def packed(message):
    net = struct.pack(">HHHHBHB", *message.dest, *message.src, message.reliable, message.number,
                      2 + len(message.data))
    return net + bytes((message.transport, message.application)) + message.data


def unpacked(payload):
    """The message in these bytes; None where they break a rule: it is dropped (N11)."""
    if len(payload) < 14:
        return None
    island, device, src_island, src_device, reliable, number, size = struct.unpack(
        ">HHHHBHB", payload[:12])
    if reliable > 1 or not 2 <= size <= 102 or len(payload) < 12 + size:
        return None
    return Message(Address(island, device), Address(src_island, src_device), reliable, number,
                   payload[12], payload[13], payload[14:12 + size])


class Channel:
    def __init__(self, is_output, peer, mode):
        self.is_output, self.peer, self.power_save = is_output, peer, mode == 1
        self.values = []      # Of four bytes each, so that a NaN equals itself.
        self.started = False
        self.fresh = False    # Not yet sent, or not yet signalled.


class Mote:
    """`world.now` is the time in ticks of 1/1024 s; `world.tx(line, packet)` puts a packet on a
    free line; `world.up(name, ...)` tells the application. rx, call, line, linkack and power are
    the commands of rct/1, with their words behind the time; `settings` are those of `reset`."""

    def __init__(self, world, settings):
        self.world, self.device, self.busy = world, int(settings["id"]), False
        self.room = int(settings["channels"])
        self.requests_max = int(settings.get("join_requests", REQUESTS))
        self.number = (1000 + 257 * int(settings["seed"])) & 0xFFFF
        self.start()

    def start(self):
        """Forgets all but its next sequence number."""
        self.is_on, self.started_at = True, self.now
        self.interfaces = {0: True, 1: True}    # Radio, serial.
        self.application_busy = False
        self.outgoing, self.incoming = collections.deque(), collections.deque()
        self.address = None                     # Of a member.
        self.request = None                     # Its number, while a joinIsland call is under way.
        self.awaited = {}                       # Reliable messages by number: (message, deadline).
        self.channels = {}                      # By (id, is_output).
        self.period = 500                       # The synaptic clock runs always (decision 121).
        self.tick_at = self.now + self.period + 30 * (self.device - 1)

    def power(self, what):
        self.is_on = False
        if what == "reboot":
            self.start()

    def call(self, *words):
        """False: there is no such call."""
        name, arguments = call_of(words)
        method = getattr(self, "call_" + name, None)
        if self.is_on and method:
            method(**arguments)
        return method is not None

    # Time.

    @property
    def now(self):
        return self.world.now

    def due(self):
        """The tick at which something happens by itself; None: never."""
        if not self.is_on:
            return None
        times = [self.tick_at] + [deadline for _, deadline in self.awaited.values()]
        return min(times + ([self.timer] if self.request is not None else []))

    def run_due(self):
        for number, (message, deadline) in list(self.awaited.items()):
            if deadline <= self.now:
                del self.awaited[number]
                self.world.up("ack_received", message.application, number, False)
        if self.request is not None and self.timer <= self.now:
            self.join_timer()
        if self.tick_at <= self.now:
            self.tick_at += self.period
            self.tick()

    # Lines.

    def transmit(self, dest, am_type, payload):
        """False when the radio is off or its buffer full."""
        if not self.interfaces[0] or len(self.outgoing) >= BUFFER:
            return False
        self.outgoing.append(struct.pack(">BHHBBB", 0, dest, self.device, len(payload), 0, am_type)
                             + payload)
        self.flush()
        return True

    def flush(self):
        while self.outgoing and not self.busy and self.is_on and self.interfaces[0]:
            packet = self.outgoing.popleft()
            if packet[7] == JOIN:
                if self.request is None or packet[8:10] != struct.pack(">H", self.request):
                    continue                           # It waited too long: asked again, or over.
                self.timer = self.now + JOIN_PERIOD    # From when it leaves (J8-PERIOD).
            self.world.tx("radio", packet)

    def line(self, line, state):
        if line == "radio":
            self.busy = state == "busy"     # Whether the mote has power or not.
            self.flush()
        if self.is_on and line == "app":
            self.application_busy = state == "busy"
            while self.incoming and not self.application_busy:
                self.message(self.incoming.popleft())

    def linkack(self, acked):
        pass    # It never asks for one.

    def rx(self, line, packet_hex):
        packet = bytes.fromhex(packet_hex)
        _, dest, src, _, _, am_type = struct.unpack(">BHHBBB", packet[:8])
        listens = self.is_on and line == "radio" and self.interfaces[0]
        if listens and dest in (self.device, ALL):
            self.heard(src, am_type, packet[8:])

    def heard(self, src, am_type, payload):
        if am_type == JOIN_REPLY:
            self.join_reply(src, payload)
        message = unpacked(payload) if am_type == NET and self.address else None
        if message is None:
            return
        if not self.application_busy:
            self.message(message)
        elif len(self.incoming) < BUFFER:
            self.incoming.append(message)

    def call_interface(self, link, on):
        if link in self.interfaces:
            self.interfaces[link] = on == 1
            self.flush()
        self.world.up("op_result", link in self.interfaces)

    def call_get_interface(self, link):
        self.world.up("interface_state", link, self.interfaces.get(link, False))

    def take_number(self):
        while self.number == REFUSED or self.number in self.awaited:
            self.number = (self.number + 1) & 0xFFFF
        number, self.number = self.number, (self.number + 1) & 0xFFFF
        return number

    # Joining.

    def call_join(self, type, transducers, actuators):
        if self.address or self.request is not None:
            self.world.up("joined", self.address or Address(0, 0), False)
            return
        self.descriptor = struct.pack(">BHB", type, transducers, actuators)
        self.requests = 0
        self.send_request()

    def send_request(self):
        self.requests += 1
        self.request = self.take_number()    # A new one for each request (decision 104).
        self.timer = self.now + JOIN_PERIOD
        self.transmit(SINK_AM, JOIN, struct.pack(">H", self.request) + self.descriptor)

    def join_timer(self):
        if self.requests < self.requests_max:
            self.send_request()
        else:
            self.request = None
            self.world.up("joined", Address(0, 0), False)

    def join_reply(self, sink, payload):
        if self.request is None or len(payload) < 10:
            return
        island, device, clock, number = struct.unpack(">HHIH", payload[:10])
        if number != self.request or device != self.device or island >= NULL:
            return
        self.address, self.sink, self.request = Address(island, device), sink, None
        self.clock, self.clock_set_at = clock, self.now
        self.transmit(sink, ACK_JOIN, struct.pack(">HHHHH", island, sink, island, device, number)
                      + self.descriptor)
        self.world.up("joined", self.address, True)

    def call_get_clock(self):
        start, since = (self.clock, self.clock_set_at) if self.address else (0, self.started_at)
        self.world.up("clock", (start + (self.now - since) * 1000 // 1024) & 0xFFFFFFFF)

    # Network and transport.

    def route(self, message):
        if message.dest.island == ALL:
            am_dest = ALL
        elif message.dest.island == self.address.island and message.dest.device != NULL:
            am_dest = message.dest.device
        else:
            am_dest = self.sink
        return self.transmit(am_dest, NET, packed(message))

    def call_send(self, dest, app_id, reliable, data):
        self.world.up("send_result", self.send(dest, app_id, reliable, data))

    def send(self, dest, app_id, reliable, data):
        if not self.address or len(data) > DATA_MAX:
            return REFUSED
        dest = Address(self.address.island if dest.island == LOCAL else dest.island,
                       self.device if dest.device == LOCAL else dest.device)
        if dest == self.address:
            return REFUSED
        message = Message(dest, self.address, reliable, self.take_number(), CONNLESS, app_id, data)
        if not self.route(message):
            return REFUSED
        if reliable:
            self.awaited[message.number] = message, self.now + ACK_TIMEOUT
        return message.number

    def message(self, message):
        if message.dest.island not in (self.address.island, ALL):
            return
        if message.dest.device not in (self.device, ALL):
            return
        if message.transport == CONNLESS and message.application in APPLICATIONS:
            self.world.up("received", message.src, message.application, message.data)
            if message.reliable and ALL not in message.dest:
                self.acknowledge(message)
        elif message.transport == RUBICON_ACK:
            self.settle(message)
        elif message.transport == SYN_CHANNEL:
            self.take_values(message.src, message.data)

    def acknowledge(self, message):
        if message.src != self.address and ALL not in message.src:
            body = struct.pack(">H", message.number)    # The number alone (decision 108).
            self.route(Message(message.src, self.address, 0, self.take_number(), RUBICON_ACK,
                               message.application, body))

    def settle(self, ack):
        has_code = len(ack.data) >= 4 and ack.data[0] == 23
        if len(ack.data) < 2:
            return
        number = struct.unpack(">H", ack.data[1:3] if has_code else ack.data[:2])[0]
        message, _ = self.awaited.get(number, (None, 0))
        if message and message.dest == ack.src and message.application == ack.application:
            del self.awaited[number]
            self.world.up("ack_received", message.application, number, True)

    # Synaptic channels.

    def create(self, is_output, peer, size, mode):
        """The channel's id, or None: refused, and nothing changed."""
        if not self.address:
            return None
        peer = Address(self.address.island if peer.island == LOCAL else peer.island, peer.device)
        ends = (self.device, peer.device) if is_output else (peer.device, self.device)
        key = ChannelId(*ends), is_output
        channel = self.channels.get(key)
        used = sum(one.is_output == is_output for one in self.channels.values())
        if channel is None and used < self.room:
            channel = Channel(is_output, peer, mode)
        if channel is None or channel.peer != peer or size == 0:
            return None
        if len(channel.values) + size > CONNECTIONS_MAX:
            return None
        self.channels[key] = channel
        channel.values += [bytes(4)] * size
        channel.fresh |= is_output
        return key[0]

    def call_create_out(self, dest, size, mode):
        made = self.create(True, dest, size, mode)
        self.world.up("channel_result", made or ChannelId(0, 0), made is not None)

    def call_create_in(self, src, size, mode):
        made = self.create(False, src, size, mode)
        self.world.up("channel_result", made or ChannelId(0, 0), made is not None)

    def both(self, channel):
        """Output and input with this id: those from the mote to itself are one channel."""
        return [key for key in self.channels if key[0] == channel]

    def call_dispose(self, channel):
        keys = self.both(channel)
        for key in keys:
            del self.channels[key]
        self.world.up("op_result", bool(keys))

    def start_channel(self, channel):
        channel.fresh |= channel.is_output and not channel.started
        channel.started = True

    def call_start(self, channel):
        keys = self.both(channel)
        for key in keys:
            self.start_channel(self.channels[key])
        self.world.up("op_result", bool(keys))

    def call_stop(self, channel):
        keys = self.both(channel)
        for key in keys:
            self.channels[key].started = False
        self.world.up("op_result", bool(keys))

    def call_start_all(self):
        for channel in self.channels.values():
            self.start_channel(channel)
        self.world.up("op_result", True)

    def call_stop_all(self):
        for channel in self.channels.values():
            channel.started = False
        self.world.up("op_result", True)

    def call_set_time_step(self, clock):
        if clock > 0:
            self.period = clock
        self.world.up("op_result", clock > 0)

    def call_write_output(self, channel, pos, value):
        one = self.channels.get((channel, True))
        known = one is not None and pos < len(one.values)
        if known:
            new = struct.pack("<f", value)
            one.fresh |= one.values[pos] != new
            one.values[pos] = new
        self.world.up("op_result", known)

    def call_read_input(self, channel, pos):
        one = self.channels.get((channel, False))
        known = one is not None and pos < len(one.values)
        self.world.up("input_value", struct.unpack("<f", one.values[pos])[0] if known else 0, known)

    def take_values(self, src, data):
        one = self.channels.get((ChannelId(src.device, self.device), False))
        if one is None or one.peer != src:
            self.world.up("syn_data", ChannelId(src.device, self.device), UNKNOWN_CHANNEL)
            return
        for pos in range(min(len(one.values), len(data) // 4)):
            one.values[pos] = data[4 * pos:4 * pos + 4]
        one.fresh = True

    def tick(self):
        running = [(key[0], one) for key, one in self.channels.items() if one.started]
        for _, one in running:
            if one.is_output and (one.fresh or not one.power_save):
                one.fresh = not self.send_values(one)
        for channel, one in running:
            if not one.is_output:
                self.world.up("syn_data", channel, NEW if one.fresh else OLD)
                one.fresh = False

    def send_values(self, channel):
        data = b"".join(channel.values)
        if channel.peer != self.address:
            return self.route(Message(channel.peer, self.address, 0, self.take_number(),
                                      SYN_CHANNEL, LEARNING, data))
        if (ChannelId(self.device, self.device), False) in self.channels:
            self.take_values(self.address, data)
        return True
