#!/usr/bin/env python3
"""`rubric monitor` of a real island: by its air, its forwarder and the tuple space of a broker.

Usage: monitor_test.py RUBRIC MOSQUITTO. All of it on this host's loopback.
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time
import unittest

from space_test import USER, Broker
from check_live_testing import BROKEN_LINE, data
from live_testing import Forwarder, LiveTest, Running
from run_test import Node
from serial_testing import PATIENCE_S, held_port
from testing import RUBRIC

# A reading of long ago.
OLD = '{"creator":"11:null","time":"2020-01-31T23:59:59.123Z","data":{"light":{"raw":9}}}'


class Watching(Running):
    """A running monitor."""

    def __init__(self, *arguments, **more):
        super().__init__("monitor", *arguments, **more)

    def until(self, pattern):
        """The next line of news with this in it."""
        seen = []
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            seen += self.text_lines(1)
            if re.search(pattern, seen[-1]):
                return seen[-1]
        raise AssertionError(f"no {pattern} in {seen}")


class Monitor(LiveTest):
    program = Watching

    def node(self, *arguments, **more):
        self.program = Node
        try:
            return self.started(*arguments, **more)
        finally:
            self.program = Watching

    def sink(self):
        sink = self.node("sink", "--island", 11, "--radio", "zep:0", "--serial", "sf-server:0")
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        return sink, air, "sf@127.0.0.1:" + sink.waits_for(rb"sf-server:(\d+)\n")

    def mote(self, number, air):
        mote = self.node("mote", "--id", number, "--radio", air, "--app", "demo",
                         "--transducers", "light,temp")
        mote.event("joined", success=True)
        return mote

    def test_an_air(self):
        _, air, serial = self.sink()
        self.node("base-station", "--island", 11, "--sink", serial).waits_for(rb"(connected)")
        watch = self.started(air, "--silent-after", 2)
        time.sleep(0.3)  # The hub of the air does not say who listens.
        mote = self.mote(5, air)
        self.assertIn("11:5 joined: telosb_demo light temp / led",
                      watch.until(r"11:5 joined"))
        self.assertRegex(watch.until("11:5 light"), r"^[\d:]{8} 11:5 light \d+, temp [-\d.]+ degC$")
        mote.process.kill()
        watch.until(r"11:5 is silent")
        self.mote(6, air)
        watch.until("11:6 joined")
        code, out, err = watch.end()
        self.assertEqual((code, err), (0, ""))
        table = out[out.index("NODE "):].splitlines()
        row = next(line for line in table if line.startswith("11:5 ")).split()
        self.assertEqual(row[:2], ["11:5", "gone"])
        self.assertGreater(int(row[2]), 0, "frames")
        self.assertEqual(row[4], "1", "joins")
        self.assertRegex(table[-1], r"^Check: (pass|inconclusive), \d+ frames")

    def test_a_finding_of_no_node(self):
        mote = self.node("mote", "--id", 5, "--radio", "zep:0")
        watch = self.started("zep:" + mote.waits_for(rb"zep:(\d+)\n"))
        self.assertRegex(watch.until("J3-REPLY"), r"INCONCLUSIVE J3-REPLY, frame \d+ at ")

    def test_a_forwarder_with_a_broken_rule(self):
        server = Forwarder(self)
        watch = self.started(f"sf@127.0.0.1:{server.port}")
        server.accept(data(BROKEN_LINE))
        self.assertIn("FAIL J6-CONTENT, sink of island 12, frame 2 at ", watch.until("FAIL "))
        code, out, err = watch.end()
        self.assertEqual((code, err), (1, ""))
        self.assertRegex(out, r"Check: fail, \d+ frames, \d+ finding")

    def broker(self):
        port = held_port()
        broker = Broker(self, port.__enter__())
        self.addCleanup(port.__exit__, None, None, None)
        return broker

    def test_an_air_and_its_space(self):
        """What both show is news once, and one frame."""
        broker = self.broker()
        _, air, serial = self.sink()
        base = self.node("base-station", "--island", 11, "--sink", serial, "--space", broker.url,
                         env={**os.environ, **USER})
        base.waits_for(rb"(mqtt://\S+: connected)")
        watch = self.started(air, broker.url, env={**os.environ, **USER})
        watch.until("11:pc is online")
        self.mote(5, air)
        for _ in range(5):
            watch.until("11:5 light")
        before = watch.read.decode()
        code, out, _ = watch.end()
        self.assertEqual(code, 0)
        seen = 5 + len(re.findall(r" 11:5 light", before + out))
        readings = (base.read.decode() + base.end()[1]).count('"data":"23')
        self.assertLess(seen, 1.5 * readings)
        row = next(line for line in out.splitlines() if line.startswith("11:5 ")).split()
        self.assertLessEqual(int(row[row.index("s") + 1]), readings + 1, "frames")

    def test_a_space(self):
        broker = self.broker()
        _, air, serial = self.sink()
        base = self.node("base-station", "--island", 11, "--sink", serial, "--space", broker.url,
                         "--gone-after", 2, env={**os.environ, **USER})
        base.waits_for(rb"(mqtt://\S+: connected)")
        watch = self.started(broker.url, env={**os.environ, **USER})
        watch.until("11:pc is online")
        mote = self.mote(5, air)
        self.assertIn("telosb_demo light temp / led", watch.until("11:5 joined"))
        watch.until(r"11:5 light \d+, temp [-\d.]+ degC")
        late = self.started(broker.url, env={**os.environ, **USER})
        late.until("11:5 joined")
        late.until("11:5 light")
        broker.publish("rubicon/11/motes/5/availability", "\x1b[31m")
        broker.publish("rubicon/11/motes/5/state", '{"a\\u001b[2Jb":{"raw":7}}')
        self.assertNotIn("\x1b", watch.until("refused 11/motes/5/availability"))
        self.assertRegex(watch.until(r"\[2Jb 7"), "11:5 a\N{REPLACEMENT CHARACTER}\\[2Jb 7$")
        mote.process.kill()
        watch.until("11:5 has gone")
        broker.publish("rubicon/11/motes/5/state", '{"light":{"raw":9}}')
        watch.until("11:5 is heard again")
        # How long ago a tuple was written makes nobody silent: it says itself who has gone.
        broker.publish("rubicon/11/motes/9/state", OLD)
        watch.until("11:9 light 9")
        base.process.kill()
        watch.until("11:pc has gone")
        code, out, _ = watch.end()
        self.assertEqual(code, 0)
        self.assertRegex(out, r"11:5 .*\(its base station has gone\)")
        self.assertRegex(out, r"\n11:9 +\d+ s ")

    def test_a_terminal_is_redrawn(self):
        self.draws(12, 70, rb"\x1b\[H[^\x1b]*NODE(?s:.*)11:5 +\d s.*light \d+")

    def test_a_narrow_terminal(self):
        self.draws(10, 40, rb"\x1b\[H[^\x1b]*NODE(?s:.*)11:5 +\d s")

    def test_a_low_terminal(self):
        self.draws(6, 60, rb"11:5 +\d s +5 ")

    def draws(self, rows, columns, pattern):
        _, air, _ = self.sink()
        end, other = pty.openpty()
        self.addCleanup(os.close, end)
        fcntl.ioctl(other, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        process = subprocess.Popen([RUBRIC, "monitor", air], stdout=other)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        os.close(other)
        time.sleep(0.3)
        self.mote(5, air)
        shown = b""
        deadline = time.monotonic() + PATIENCE_S
        while not re.search(pattern, shown):
            self.assertLess(time.monotonic(), deadline, shown)
            if select.select([end], [], [], 0.2)[0]:
                shown += os.read(end, 4096)
        process.send_signal(signal.SIGINT)
        while True:  # Until nobody has the terminal.
            try:
                shown += os.read(end, 4096)
            except OSError:
                break
        for screen in shown.split(b"\x1b[H")[1:-1]:
            self.assertLessEqual(screen.count(b"\n"), rows)
            for line in screen.split(b"\x1b[J")[0].split(b"\x1b[K"):
                self.assertLessEqual(len(line.strip()), columns)
        self.assertIn(b"\x1b[?1049l", shown)
        self.assertEqual(process.wait(PATIENCE_S), 0)

    def test_clear_errors(self):
        for arguments, code, text in (
                ((), 64, "SOURCE"), (("run.pcapng",), 64, "expected a line such as"),
                (("mqtt://me:secret@x",), 64, "into a file or the environment"),
                (("sf@127.0.0.1:1",), 66, "refused")):
            self.shows(("monitor", *arguments), code=code, err=text)


if __name__ == "__main__":
    unittest.main()
