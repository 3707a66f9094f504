"""Your mote goes here, or the bridge to it. Whatever is marked TODO is yours to write.

It has no clock of its own: adapter.py sets `now` (ticks of 1/1024 s), gives it what happens, and
calls run_due() when due() says so. What the mote does, it tells its `world`:
    world.tx("radio", packet)           a frame leaves; packet begins 00, destination, source, ...
    world.up("joined", address, True)   news for the application
"""

from typing import NamedTuple


class Address(NamedTuple):
    island: int
    device: int

    def __str__(self):
        return f"{self.island}:{self.device}"


class ChannelId(NamedTuple):
    source: int
    destination: int

    def __str__(self):
        return f"{self.source}->{self.destination}"


class Mote:
    """One that has just started, with nothing remembered but the next sequence number."""

    def __init__(self, world, device, channels, number, now):
        self.world, self.device, self.channels = world, device, channels
        self.number, self.now, self.started_at = number, now, now

    def due(self):
        """The tick at which something happens by itself; None: never."""
        return None    # TODO: the soonest of your timers.

    def run_due(self):
        """Does what is due now."""
        # TODO: what your timers do.

    def heard(self, line, packet):
        """A frame came by "radio" or "serial", whoever it is for."""
        # TODO: hand it to your receiver.

    def set_busy(self, line, busy):
        """Somebody else has the line, or left it. "app": the application takes no messages."""
        # TODO: what is to be sent, or handed up, waits meanwhile.

    # Calls of the application: call_NAME, with the arguments by their names. A call that is not
    # here is answered `unsupported`, and the cases that need it are skipped.

    def call_get_clock(self):
        self.world.up("clock", (self.now - self.started_at) * 1000 // 1024)

    # TODO: call_join(self, type, transducers, actuators), then call_send(self, dest, app_id,
    # reliable, data), and so on; PORTING.md has the list.
