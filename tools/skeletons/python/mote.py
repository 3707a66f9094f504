"""Your mote goes here, or the bridge to it. Whatever is marked TODO is yours to write.

It has no clock of its own: `world.now` is the time (ticks of 1/1024 s). adapter.py gives it what
happens, and calls run_due() when due() says so. What the mote does, it tells its `world`:
    world.tx("radio", packet)           a frame leaves; packet begins 00, destination, source, ...
    world.up("joined", address, True)   news for the application
"""

from words import Address, call_of    # And ChannelId.

# What `reset` may say. Add a parameter, as "join_requests", if your mote can be built with it.
SETTINGS = {"id", "island", "channels", "seed", "profile"}


class Mote:
    def __init__(self, world, settings):
        self.world, self.device = world, int(settings["id"])
        self.number = (1000 + 257 * int(settings["seed"])) & 0xFFFF
        self.start()

    def start(self):
        """As one that has just started: nothing is remembered but the next sequence number."""
        self.is_on, self.started_at = True, self.world.now
        # TODO: what your mote is at its start.

    def due(self):
        """The tick at which something happens by itself; None: never."""
        return None    # TODO: the soonest of your timers, while it is on.

    def run_due(self):
        """Does what is due now."""
        # TODO: what your timers do.

    # The commands of rct/1, with their words after the time.

    def rx(self, line, packet_hex):
        """A frame came by "radio" or "serial", whoever it is for."""
        packet = bytes.fromhex(packet_hex)
        # TODO: hand the packet to your receiver.

    def line(self, line, state):
        """Somebody else has the line ("busy"), or left it ("idle"). "app": the application takes
        no messages."""
        # TODO: what is to be sent, or handed up, waits meanwhile.

    def linkack(self, acked):
        """Handles the end of the transmission that you asked for: "1" is acked. See PORTING.md."""

    def power(self, what):
        self.is_on = False
        if what == "reboot":
            self.start()

    def call(self, *words):
        """A call of the application. False: there is no such call, so the case is skipped."""
        name, arguments = call_of(words)
        method = getattr(self, "call_" + name, None)
        if self.is_on and method:
            method(**arguments)
        return method is not None

    def call_get_clock(self):
        self.world.up("clock", (self.world.now - self.started_at) * 1000 // 1024)

    # TODO: call_join(self, type, transducers, actuators), which answers with
    #     self.world.up("joined", Address(11, self.device), True)
    # later; then call_send(self, dest, app_id, reliable, data), and so on. PORTING.md has the list.
