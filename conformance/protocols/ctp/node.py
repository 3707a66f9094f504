#!/usr/bin/env python3
"""The routing and forwarding engines of CTP, written from TEP 123 and TEP 119.

Links are not estimated: the application's `link` says what a link estimator would.
"""

import random
import struct

import rct

ROUTING, DATA = 0x70, 0x71    # AM types.
PULL, CONGESTED = 0x80, 0x40
NOBODY, NO_ROUTE = 0xFFFF, 0xFFFF
ETX_LIMIT = 650               # No route is worse, in tenths.
SIGNIFICANT = 20              # A change of the own ETX that others should know, in tenths.
CACHED = 8                    # Data frames remembered as duplicates.
PACE = 16, 32                 # Ticks between data frames.

BEACON = struct.Struct(">BBBHH")    # Link estimator (2), options, parent, ETX.
HEAD = struct.Struct(">BBHHBB")     # Options, THL, ETX, origin, seqno, collect id.


class Node:
    def __init__(self, world, role, id, seed, transmissions, queue, beacon_min, beacon_max):
        self.world, self.id, self.random = world, id, random.Random(seed)
        self.transmissions, self.room = transmissions, queue
        self.intervals = beacon_min, beacon_max
        self.is_root = False
        self.links = {}        # Neighbour: ETX of the link.
        self.neighbours = {}   # Neighbour: (its parent, its ETX), as it said last.
        self.parent, self.etx = NOBODY, NO_ROUTE
        self.queue = []        # [THL, origin, seqno, collect id, data], the first one under way.
        self.tries = 0         # Transmissions of the first one.
        self.busy = False      # It is on the air, or rests between frames.
        self.seen = []
        self.seqno = self.random.randrange(256)
        self.dropped_for_data = self.dropped_for_beacon = False
        self.leep_seqno = 0
        self.timer = None
        self.interval = beacon_min
        self.begin_interval()

    # Routing.

    def choose_route(self):
        before = self.etx
        if self.is_root:
            self.parent, self.etx = self.id, 0
        else:
            routes = [(etx + self.links[neighbour], neighbour != self.parent, neighbour)
                      for neighbour, (parent, etx) in self.neighbours.items()
                      if neighbour in self.links and parent != self.id]
            routes = [route for route in routes if route[0] < ETX_LIMIT]
            self.etx, _, self.parent = min(routes, default=(NO_ROUTE, True, NOBODY))
        if abs(before - self.etx) >= SIGNIFICANT:
            self.beacon_soon()
        self.send_data()

    def has_route(self):
        return self.etx != NO_ROUTE

    def begin_interval(self):
        """Trickle: a frame at a random time in the second half of an interval, which doubles."""
        half = self.interval // 2
        at = half + self.random.randrange(half)
        self.rest = self.interval - at
        self.timer = self.world.after(at, self.send_beacon)

    def beacon_soon(self):
        if self.interval == self.intervals[0]:
            return
        self.world.cancel(self.timer)
        self.interval = self.intervals[0]
        self.begin_interval()

    def send_beacon(self):
        options = 0 if self.has_route() else PULL
        if self.dropped_for_beacon:
            options |= CONGESTED
        self.dropped_for_beacon = False
        self.leep_seqno = (self.leep_seqno + 1) % 256
        self.world.transmit(rct.BROADCAST, self.id, ROUTING,
                            BEACON.pack(0, self.leep_seqno, options, self.parent, self.etx))
        self.interval = min(2 * self.interval, self.intervals[1])
        self.timer = self.world.after(self.rest, self.begin_interval)

    def hear_beacon(self, src, options, parent, etx):
        self.neighbours[src] = parent, etx
        self.choose_route()
        if parent == self.id and etx < self.etx:
            self.beacon_soon()

    # Forwarding.

    def hear_data(self, etx, thl, packet):
        if (thl, packet[:3]) in self.seen:
            return
        if etx < self.etx:
            self.beacon_soon()
        thl = (thl + 1) % 256
        if self.is_root:
            self.remember(thl - 1, packet)
            self.deliver(packet)
        elif len(self.queue) >= self.room:
            self.note_drop()
        else:
            self.remember(thl - 1, packet)
            self.queue.append([thl, *packet])
            self.send_data()

    def remember(self, thl, packet):
        self.seen = [*self.seen, (thl % 256, packet[:3])][-CACHED:]

    def note_drop(self):
        self.dropped_for_data = self.dropped_for_beacon = True

    def deliver(self, packet):
        origin, _, collect_id, data = packet
        self.world.tell("received", origin=origin, collect_id=collect_id, data=data)

    def send_data(self):
        if self.busy or not self.queue or not self.has_route():
            return
        thl, origin, seqno, collect_id, data = self.queue[0]
        options = CONGESTED if self.dropped_for_data else 0
        self.dropped_for_data = False
        self.tries += 1
        self.busy = True
        head = HEAD.pack(options, thl, self.etx, origin, seqno, collect_id)
        self.world.transmit(self.parent, self.id, DATA, head + data, ack=True)

    def sent(self, acked):
        if not self.tries:
            return    # Nothing of this node's was on the air.
        if acked or self.tries >= self.transmissions:
            _, origin, _, _, _ = self.queue.pop(0)
            self.tries = 0
            if not acked:
                self.note_drop()
            if origin == self.id:
                self.world.tell("send_done", result=acked)
        self.world.after(self.random.randint(*PACE), self.rest_is_over)

    def rest_is_over(self):
        self.busy = False
        self.send_data()

    # The radio.

    def heard(self, dest, src, am_type, payload):
        frame = {ROUTING: BEACON, DATA: HEAD}.get(am_type)
        if not frame or len(payload) < frame.size:
            return
        options = payload[2 if am_type == ROUTING else 0]
        if options & PULL and self.has_route():
            self.beacon_soon()
        if am_type == ROUTING:
            self.hear_beacon(src, *BEACON.unpack_from(payload)[2:])
        elif dest == self.id:
            _, thl, etx, *packet = HEAD.unpack_from(payload)
            self.hear_data(etx, thl, (*packet, payload[HEAD.size:]))

    # The application.

    def call_link(self, neighbor, etx):
        self.links.pop(neighbor, None)
        if etx != NO_ROUTE:
            self.links[neighbor] = etx
        self.choose_route()

    def call_send(self, collect_id, data):
        accepted = self.is_root or len(self.queue) < self.room
        self.world.tell("send_result", result=accepted)
        if not accepted:
            return
        packet = self.id, self.seqno, collect_id, data
        self.seqno = (self.seqno + 1) % 256
        if self.is_root:
            self.deliver(packet)
            self.world.tell("send_done", result=True)
        else:
            self.queue.append([0, *packet])
            self.send_data()

    def call_set_root(self):
        self.is_root = True
        self.choose_route()
        self.world.tell("op_result", result=True)

    def call_unset_root(self):
        self.is_root = False
        self.choose_route()
        self.world.tell("op_result", result=True)

    def call_is_root(self):
        self.world.tell("root_state", root=self.is_root)

    def call_get_etx(self):
        self.world.tell("etx", etx=self.etx)


rct.serve(Node, "rubric_python_ctp", ["node"],
          transmissions=31, queue=12, beacon_min=128, beacon_max=524288)
