#!/usr/bin/env python3
"""`rubric run`: nodes on a virtual air, whole islands, and what check says of what they kept.

Usage: run_test.py RUBRIC [Minute]. All of it on this host's loopback. Each step
waits for what it needs, and only a bound of patience ends it otherwise; Minute alone runs for a
minute.
"""

import fcntl
import json
import pathlib
import re
import socket
import subprocess
import time
import unittest

from live_testing import Flood, LiveTest, Running, lines_of
from serial_testing import PATIENCE_S, held_port, read_until
from station_load import PACKET, message
from testing import ROOT, RUBRIC, rubric

# The PC of an island knocks at the door of another until it is open.
KNOCK = """
import json, sys, time
def knock():
    print(json.dumps({"call": "send", "dest": "11:5", "app_id": 10, "reliable": True,
                      "data": b"OPEN_DOOR".hex()}), flush=True)
time.sleep(0.5)
knock()
for line in sys.stdin:
    event = json.loads(line)
    if event["event"] in ("ack_received", "send_result") and not event["success"]:
        time.sleep(0.2)
        knock()
    if event["event"] == "ack_received" and event["success"] and len(sys.argv) > 1:
        knock()
"""

# Says so much that no small pipe takes its events, and ends.
TALKS = 60
TALK = f"""
import json, sys
def call(name, **what):
    print(json.dumps({{"call": name, **what}}), flush=True)
call("join", type=1, transducers=1, actuators=1)
count = 0
for line in sys.stdin:
    event = json.loads(line)["event"]
    count += event == "ack_received"
    if count == {TALKS}:
        break
    if event in ("joined", "ack_received"):
        call("send", dest="11:65533", app_id=10, reliable=True, data="01")
"""

# Applications that join, and do something when their input has ended.
WAITS = """
import pathlib, sys, time
print('{{"call":"join","type":1,"transducers":1,"actuators":1}}', flush=True)
sys.stdin.read()
path = pathlib.Path("{path}")
while not path.exists() or path.read_text() != "second":
    time.sleep(0.01)
path.write_text("second first")
"""
ENDS = """
import pathlib, sys
print('{{"call":"join","type":1,"transducers":1,"actuators":1}}', flush=True)
sys.stdin.read()
pathlib.Path("{path}").write_text("second")
"""


class Node(Running):
    """A running node: what it says, and its calls."""

    def __init__(self, *arguments, **more):
        super().__init__("run", *arguments, stdin=subprocess.PIPE, **more)
        self.said = b""

    def waits_for(self, pattern):
        """The first group of the next text on stderr that matches."""
        self.said, came = read_until(self.process.stderr.fileno(),
                                     lambda said: re.search(pattern, said), self.said)
        if not came:
            raise AssertionError(f"no {pattern} in {self.said}")
        found = re.search(pattern, self.said)
        self.said = self.said[found.end():]
        return found.group(1).decode()

    def event(self, name, **fields):
        """The next event of that name with these fields."""
        while True:
            event = self.lines(1)[0]
            if event["event"] == "error":
                raise AssertionError(event)
            if event["event"] == name and fields.items() <= event.items():
                return event

    def call(self, call, **arguments):
        self.process.stdin.write(json.dumps({"call": call, **arguments}).encode() + b"\n")
        self.process.stdin.flush()


class IslandTest(LiveTest):
    program = Node

    def island(self, kept):
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial",
                            "sf-server:0", "--seed", "1", "--write", kept)
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        serial = "sf@localhost:" + sink.waits_for(rb"sf-server:(\d+)\n")
        base = self.started("base-station", "--island", "11", "--sink", serial, "--app", "-")
        base.waits_for(rb"(connected)")
        return sink, base, air

    def judged(self, *files):
        code, out, _ = rubric("check", *files, "--format", "json")
        report = json.loads(out)
        bad = [one["text"] for one in report["findings"]
               if one["severity"] in ("fail", "weak", "stray")]
        self.assertEqual((bad, code), ([], 0), files)
        return report


class Run(IslandTest):
    def test_an_island_keeps_the_rules(self):
        kept = self.folder / "run.pcapng"
        sink, base, air = self.island(kept)
        two = self.started("mote", "--id", "2", "--radio", air, "--app", "-", "--seed", "2")
        two.call("join", type=1, transducers=3, actuators=1)
        two.event("joined", own="11:2", success=True)
        three = self.started("mote", "--id", "3", "--radio", air, "--seed", "3")
        three.event("joined", own="11:3", success=True)
        for mote in ("11:2", "11:3"):
            sink.event("mote_joined", mote=mote)
            base.event("received", src=mote)
        two.call("send", dest="11:3", app_id=10, reliable=True, data="0102")
        number = two.event("send_result", success=True)["seq_num"]
        three.event("received", src="11:2", app_id=10, data="0102")
        two.event("ack_received", seq_num=number, success=True)
        base.call("send", dest="11:2", app_id=10, reliable=True, data="0a")
        number = base.event("send_result", success=True)["seq_num"]
        two.event("received", app_id=10, data="0a")
        base.event("ack_received", seq_num=number, success=True)
        two.call("send", dest="11:65533", app_id=10, reliable=False, data="0b")
        base.event("received", src="11:2", data="0b")
        for node in (two, three, base, sink):
            self.assertEqual(node.end()[0], 0)
        messages = [record["message"] for record in lines_of(kept)]
        for wanted in ("join_request", "join_reply", "ack_join", "mac_ack", "config"):
            self.assertIn(wanted, messages)
        self.assertIn("mote 3", self.passes(kept))

    def islands(self, more="", knock="", loss=5):
        """Two islands with loss; the PC of island 12 opens the door of island 11."""
        knocker = self.write("knock.py", KNOCK)
        door = ROOT / "conformance/node/examples/door.py"
        plan = self.write("islands.yaml", f"""
loss: {loss}
seed: 5
islands:
  - island: 11
    radio: zep:0
    motes:
      - {{id: 5, app: python3 {door}}}
      - {{id: 2, transducers: [light, temp], app: demo}}
{more}
  - island: 12
    radio: zep:0
    app: python3 {knocker} {knock}
    motes:
      - {{id: 7, app: demo}}
""")
        return self.started(plan, "--write", self.folder / "run.pcapng", "--log",
                            self.folder / "run.rtr")

    def test_two_islands_with_loss(self):
        run = self.islands()
        waited = {("pc12", "11:5"): b"DOOR_IS_OPEN".hex(), ("mote11_5", "12:65533"): None,
                  ("pc11", "11:2"): None, ("pc12", "12:7"): None}
        while waited:
            event = run.event("received")
            at = (event["node"], event["src"])
            if waited.get(at) in (None, event["data"]):
                waited.pop(at, None)
        code, _, err = run.end()
        self.assertEqual(code, 0, err)
        self.judged(self.folder / "run.pcapng")
        report = self.judged(self.folder / "run.rtr")
        exercised = {one["requirement"] for one in report["exercised"]}
        self.assertLessEqual({"N8-PEIS", "N8-INCOMING", "T3-SUCCESS", "J4-CONTENT"}, exercised)

    def test_a_log_of_one_node(self):
        kept = self.folder / "run.rtr"
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--log", kept)
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        mote = self.started("mote", "--id", "4", "--radio", air, "--app", "demo",
                            "--transducers", "light,temp", "--log", self.folder / "mote.rtr")
        mote.event("joined", success=True)
        time.sleep(2.2)
        for node in (mote, sink):
            self.assertEqual(node.end()[0], 0)
        self.judged(kept)
        # A reply that the mote was given is one, though the log shows no sink that sent it.
        report = self.judged(self.folder / "mote.rtr")
        self.assertEqual([one["text"] for one in report["findings"]
                          if one["severity"] == "inconclusive"], [])

    def test_a_pty_is_a_serial_device(self):
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial", "pty")
        device = sink.waits_for(rb"(serial@/dev/\S+)")
        base = self.started("base-station", "--island", "12", "--sink", device, "--app", "-")
        base.waits_for(rb"(connected)")
        self.assertEqual(sink.waits_for(rb"changed the island to (\d+), which was 11"), "12")
        base.call("send", dest="12:1", app_id=10, reliable=True, data="0a")
        number = base.event("send_result", success=True)["seq_num"]
        sink.event("received", src="12:65533", data="0a")
        base.event("ack_received", seq_num=number, success=True)
        for node in (base, sink):
            self.assertEqual(node.end()[0], 0)

    def test_a_mote_that_was_killed_comes_back(self):
        """Its sink lists it until it has been silent for the stated time (decision 124)."""
        kept = self.folder / "run.rtr"
        radio = self.folder / "run.pcapng"
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial",
                            "sf-server:0", "--gone-after", "1", "--log", kept, "--write", radio)
        air = "zep:" + sink.waits_for(rb"zep:(\d+)\n")
        serial = "sf@localhost:" + sink.waits_for(rb"sf-server:(\d+)\n")
        base = self.started("base-station", "--island", "11", "--sink", serial, "--gone-after", "1")
        base.waits_for(rb"(connected)")
        mote = self.started("mote", "--id", "5", "--radio", air, "--seed", "2")
        mote.event("joined", own="11:5", success=True)
        base.event("received", src="11:5")
        mote.process.kill()
        mote = self.started("mote", "--id", "5", "--radio", air, "--seed", "3")
        for node in (sink, base):
            node.event("mote_left", mote="11:5")
        mote.event("joined", own="11:5", success=True)
        sink.event("mote_joined", mote="11:5")
        base.event("received", src="11:5")
        self.assertEqual(mote.end()[0], 0)
        for node in (base, sink):
            self.assertEqual(node.end()[0], 0)
        self.judged(kept)
        self.assertIn("mote_left(address=11:5)", kept.read_text(encoding="utf-8"))
        self.judged(radio, "--state", "gone_after=1024")
        self.assertIn("J2-LISTED", rubric("check", radio)[1])

    def test_a_sink_waits_on_its_lines(self):
        """It runs when a line brings something, not some time later: it does not look again and
        again."""
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial", "sf-server:0")
        port = int(sink.waits_for(rb"sf-server:(\d+)\n"))
        with socket.create_connection(("127.0.0.1", port)) as host:
            host.sendall(b"U ")
            self.assertEqual(host.recv(2), b"U ")
            sink.waits_for(rb"(connected)")
            status = pathlib.Path(f"/proc/{sink.process.pid}/status")
            woken = []
            for _ in range(2):
                time.sleep(0.5)
                woken.append(int(re.search(r"\nvoluntary_ctxt_switches:\s+(\d+)",
                                           status.read_text(encoding="utf-8")).group(1)))
            # The tenth of a second in which a stop is seen: five times. Every 5 ms: 100 times.
            self.assertLess(woken[1] - woken[0], 25)
        self.assertEqual(sink.end()[0], 0)

    def test_nobody_waits_for_a_slow_reader(self):
        """Events that nobody reads wait, or are lost; messages are acknowledged."""
        place = socket.create_server(("127.0.0.1", 0))
        place.settimeout(PATIENCE_S)
        base = self.started("base-station", "--island", "11", "--sink",
                            f"sf@127.0.0.1:{place.getsockname()[1]}")
        line, _ = place.accept()
        place.close()
        line.settimeout(PATIENCE_S)
        self.addCleanup(line.close)
        line.sendall(b"U ")
        answers, count = b"", 2000  # More than a pipe takes: 64 KiB.
        for number in range(count):
            data = message(5, number)
            line.sendall(bytes([len(data)]) + data)
            while len(answers) < 2 + 12 + (number + 1) * (1 + PACKET):
                more = line.recv(1 << 16)
                self.assertTrue(more, base.process.poll())
                answers += more
        self.assertEqual(len(base.lines(count)), count)
        self.assertEqual(base.end()[0], 0)

    def test_a_flood_does_not_hold_it(self):
        place = socket.create_server(("127.0.0.1", 0))
        base = self.started("base-station", "--island", "11", "--sink",
                            f"sf@127.0.0.1:{place.getsockname()[1]}")
        place.settimeout(PATIENCE_S)
        line, _ = place.accept()
        place.close()
        self.addCleanup(line.close)
        line.sendall(b"U ")
        base.waits_for(rb"(connected)")
        packet = bytes.fromhex("00ffff0001042209") + b"abcd"  # Nothing to answer.
        Flood(line, bytes([len(packet)]) + packet)
        code, _, err = base.end()
        self.assertEqual(code, 0, err)

    def mote_file(self, *apps):
        """A file with a mote for each of these applications, in Python, the first one mote 2."""
        motes = ""
        for number, app in enumerate(apps, 2):
            script = self.write(f"app{number}.py", app)
            motes += f"      - {{id: {number}, app: exec python3 {script}}}\n"
        return self.write("motes.yaml",
                          f"islands:\n  - island: 11\n    radio: zep:0\n    motes:\n{motes}")

    def test_a_node_that_ends_takes_no_events_along(self):
        """All nodes of a file write to one output, which a slow reader has not taken yet."""
        run = self.started(self.mote_file(TALK))
        fcntl.fcntl(run.process.stdout, fcntl.F_SETPIPE_SZ, 4096)
        self.assertEqual(run.waits_for(rb"application of (mote11_2) has ended, and the node with"),
                         "mote11_2")
        # The rest of the island goes on meanwhile.
        time.sleep(1.5)
        for _ in range(1 + TALKS):  # That it has joined is the first.
            run.event("received", node="pc11", src="11:2", app_id=10)
        code, _, err = run.end()
        self.assertEqual((code, err), (0, ""))

    def test_base_stations_hear_of_the_first_joins(self):
        """No mote joins before somebody listens at its sink's serial line."""
        islands = range(11, 16)
        plan = self.write("islands.yaml", "islands:\n" + "".join(
            f"  - {{island: {island}, radio: 'zep:0', motes: [{{id: 5}}]}}\n"
            for island in islands))
        run = self.started(plan)
        told = {run.event("received")["src"] for _ in islands}
        self.assertEqual(told, {f"{island}:5" for island in islands})
        self.assertEqual(run.end()[0], 0)

    def test_applications_end_together(self):
        """The first waits for what the second does when its input has ended."""
        path = self.folder / "second"
        run = self.started(self.mote_file(WAITS.format(path=path), ENDS.format(path=path)))
        for _ in range(2):
            run.event("joined", success=True)
        self.assertEqual(run.end()[0], 0)
        self.assertEqual(path.read_text(encoding="utf-8"), "second first")

    def test_outputs_that_break(self):
        """Without a reader of stderr it goes on; without one of stdout it ends."""
        # Threads say that one has joined, and that the application of the other has ended.
        plan = self.write("islands.yaml", "islands:\n  - {island: 11, radio: 'zep:0', motes: "
                          "[{id: 2}, {id: 3, app: 'true'}]}\n")
        for stream in ("2>/dev/full", "2>&1 | head -1"):
            done = subprocess.run(["bash", "-c", f'timeout -s INT 2 "$0" run "$1" {stream}; '
                                   'exit ${PIPESTATUS[0]}', RUBRIC, plan], check=False,
                                  capture_output=True)
            self.assertIn(done.returncode, (74, 124), done)
        for what in ((plan,), ("mote", "--id", "5", "--radio", "zep:0")):
            with open("/dev/full", "wb") as full:
                done = subprocess.run([RUBRIC, "run", *what], check=False, stdout=full,
                                      stderr=subprocess.PIPE, timeout=PATIENCE_S)
            self.assertEqual(done.returncode, 74, done.stderr)
            self.assertTrue(done.stderr.endswith(
                b"rubric: cannot write stdout: No space left on device\n"), done.stderr)

    def test_files_that_cannot_be_written(self):
        node = ("run", "mote", "--id", "5", "--radio", "zep:0")
        old = self.write("old", "")
        for option in ("--write", "--log"):
            self.refused((*node, option, old), f"{option}: {old} exists; --force replaces it")
            self.refused((*node, option, "/none/x"),
                         "rubric: cannot write /none/x: No such file or directory", 74)
        self.refused((*node, "--force"), "--force requires --write or --log")

    def test_a_log_that_breaks_says_so_at_once(self):
        mote = self.started("mote", "--id", "5", "--radio", "zep:0", "--log", "/dev/full")
        mote.waits_for(rb"(cannot write /dev/full)")
        self.assertIsNone(mote.process.poll())
        self.assertEqual(mote.end()[0], 74)

    def test_a_closed_stdout_is_no_file(self):
        kept = self.folder / "run.pcapng"
        command = 'exec "$0" run mote --id 5 --radio zep:0 --app - --write "$1" >&-'
        subprocess.run(["sh", "-c", command, RUBRIC, kept], check=False,
                       input=b'{"call":"get_clock"}\n')
        self.assertNotIn(b"clock", kept.read_bytes())
        self.assertEqual(kept.read_bytes()[:4], b"\n\r\r\n")

    def test_options_beside_a_file(self):
        plan = self.mote_file()
        plan.write_text("islands:\n  - {island: 11, radio: zep:0}\n", encoding="utf-8")
        for option, value in (("--id", "5"), ("--island", "11"), ("--radio", "zep:0"),
                              ("--serial", "pty"), ("--sink", "sf@x:1"), ("--app", "demo"),
                              ("--target", "machine"), ("--type", "2"), ("--loss", "5"),
                              ("--transducers", "temp"), ("--actuators", "open"),
                              ("--listen", "1"), ("--network", "lines:x:1")):
            code, _, err = rubric("run", plan, option, value)
            self.assertEqual(code, 64, err)
            self.assertRegex(err, option + ": (write it in FILE.yaml|is for .*, not for a file)")
        log = self.folder / "run.rtr"
        run = self.started(plan, "--gone-after", "30", "--log", log)
        run.waits_for(rb"(connected)")
        self.assertEqual(run.end()[0], 0)
        self.assertEqual(log.read_text(encoding="utf-8").count("gone_after=30720"), 2)

    def test_lines_that_are_too_long_or_have_no_end(self):
        mote = self.started("mote", "--id", "5", "--radio", "zep:0", "--app", "-")
        mote.process.stdin.write(b"x" * (1 << 17) + b'\n{"call":"get_clock"}\n')
        mote.process.stdin.flush()
        self.assertEqual(mote.lines(1)[0],
                         {"event": "error", "text": "a line of more than 65536 bytes"})
        self.assertEqual(mote.lines(1)[0]["event"], "clock")
        mote.process.stdin.write(b'{"call":"get_clock"}')
        mote.process.stdin.close()
        self.assertEqual(mote.lines(1)[0]["event"], "clock")
        self.assertEqual(mote.end(None)[0], 0)

    def test_mistakes_of_a_file_have_their_line(self):
        island = "islands:\n  - island: 11\n"
        for text, line, what in (
                ("loss: 5\nislans: []\n", 2, "unknown key 'islans'"),
                ("", 1, "the file: expected keys and values, such as 'islands: [{island: 11}]', "
                        "not given"),
                ("loss: 5%\n" + island, 1, "loss in percent: expected a number from 0 to 100, "
                                           "given '5%'"),
                ("islands:\n  - island 11\n", 2, "such as 'island: 11', given 'island 11'"),
                ("islands:\n", 1, "islands has no value"),
                ("loss: 5\n", 1, "the file has no 'islands'"),
                (island + "    motes:\n", 3, "motes has no value"),
                (island + "    motes: {id: 5}\n", 3, "such as '[{id: 5}]', given keys and values"),
                (island + "    motes: [5]\n", 3, "such as '{id: 5}', given '5'"),
                (island + "    app: demo\n", 3, "app: the demo is a mote's"),
                (island + "    sink_app: demo\n", 3, "sink_app: the demo is a mote's"),
                (island + "    motes: [{id: 2, app: '-'}]\n", 3, "app: expected a command"),
                (island + "    motes: [{id: 2, app: door, type: 1}]\n", 3,
                 "type is for a mote that joins by itself"),
                (island + "    motes: [{id: 2, app: a b: c}]\n", 3,
                 "a colon or comma needs quotes"),
                ("islands:\n\t- island: 11\n", 2, "a tab before the text"),
                (island + "   radio: zep:0\n", 3, "begins at no column of a list or key above"),
                (island + "---\n" + island, 3, "belongs to nothing"),
                ("space: mqtt://\n" + island, 1, "space: 'mqtt://': no host"),
                ("space: mqtt://me:secret@x\n" + island, 1, "RUBRIC_MQTT_USER"),
                ("loss: 101\n" + island, 1, "from 0 to 100"),
                (island + "  - island: 11\n", 3, "there is an island 11 already"),
                (island + "    radio: sf@x:1\n", 3, "expected zep:PORT"),
                (island + "    serial: tty\n", 3, "sf-server:PORT or pty"),
                (island + "    motes:\n      - id: 1\n", 4, "from 2 to 65532"),
                (island + "    motes:\n      - {id: 2}\n      - {id: 2}\n", 5, "a mote 2 already"),
                (island + "    motes:\n      - {id: 2, transducers: [lite]}\n", 4,
                 "'lite' is none of: light temp"),
                (island + "    serial: pty\n    app: x\n", 4, "the program at 'serial'"),
                ("space: peis\n" + island, 1, "memory or mqtt://"),
                ("islands: [\n", 2, "no comma or bracket where one must be")):
            plan = self.write("islands.yaml", text)
            code, _, err = rubric("run", plan)
            self.assertEqual(code, 64, err)
            self.assertIn(f"{plan}:{line}: ", err)
            self.assertIn(what, err)
        self.write("islands.yaml", island)
        self.refused(("run", plan, "--home-assistant"),
                     "--home-assistant: needs a space at a broker")
        self.write("islands.yaml",
                   island + "    radio: zep:0\n    motes: [{id: 2, target: 'machine:x'}]\n")
        self.refused(("run", plan), "rubric: mote11_2: the machine has no flaw 'x'")

    def test_a_base_station_comes_back_to_its_sink(self):
        place = socket.create_server(("127.0.0.1", 0))
        port = place.getsockname()[1]
        base = self.started("base-station", "--island", "12", "--sink", f"sf@127.0.0.1:{port}")
        for _ in range(2):
            place.settimeout(PATIENCE_S)
            connection, _ = place.accept()
            self.assertEqual(connection.recv(2), b"U ")
            connection.sendall(b"U ")
            base.waits_for(rb"(connected)")
            # SET_ISLAND_ID, at each coming.
            self.assertTrue(connection.recv(64))
            connection.close()
            base.waits_for(rb"(closed it|broke)")
        place.close()
        self.assertEqual(base.end()[0], 0)

    def test_a_sink_has_one_base_station(self):
        sink = self.started("sink", "--island", "11", "--radio", "zep:0", "--serial", "sf-server:0")
        serial = "sf@127.0.0.1:" + sink.waits_for(rb"sf-server:(\d+)\n")
        first = self.started("base-station", "--island", "11", "--sink", serial)
        first.waits_for(rb"(connected)")
        second = self.started("base-station", "--island", "11", "--sink", serial)
        second.waits_for(rb"(it may serve another program)")
        sink.waits_for(rb"(another program was turned away)")
        first.process.kill()
        second.waits_for(rb"(connected)")

    def test_clear_errors(self):
        for arguments, text in (
                (("mote",), "--id: a mote needs one"),
                (("mote", "--id", "1"), "from 2 to 65532"),
                (("mote", "--id", "2", "--island", "11"),
                 "--island: is for a sink or base-station or proxy, not for a mote"),
                (("sink",), "--island: is needed by a sink"),
                (("sink", "--island", "65535"), "--island"),
                (("sink", "--island", "0"), "--island"),
                (("sink", "--island", "11", "--sink", "sf@x:1"),
                 "--sink: is for a base-station or proxy, not for a sink"),
                (("mote", "--id", "2", "--listen", "0"), "--listen: is for a proxy"),
                (("base-station", "--island", "11", "--radio", "zep:17754"),
                 "--radio: is for a mote or sink"),
                (("base-station", "--island", "11", "--transducers", "temp"),
                 "--transducers: is for a mote"),
                (("mote", "--id", "2", "--app", "-", "--type", "2"),
                 "--type: is for a mote that joins by itself"),
                (("base-station", "--island", "11", "--credentials", "x"),
                 "--credentials: needs a space at a broker"),
                (("mote", "--id", "2", "--radio", "sf@x:1"), "expected zep:PORT"),
                (("mote", "--id", "2", "--seed", "4294967296"),
                 "whole number from 0 to 4294967295"),
                (("sink", "--island", "11", "--serial", "9002"), "expected sf-server:PORT"),
                (("sink", "--island", "11", "--app", "demo"), "the demo is a mote's"),
                (("mote", "--id", "2", "--actuators", "hand"), "'hand' is none of: led open"),
                (("mote", "--id", "2", "--type", "z1"), "none of: telosb_demo"),
                (("sink", "--island", "11", "--space", "mqtt://x"), "is for a base-station or"),
                (("base-station", "--island", "11", "--space", "http://x"), "mqtt://HOST"),
                (("base-station", "--island", "11", "--space", "mqtt://me:secret@x"),
                 "into a file or the environment"),
                (("base-station", "--island", "11", "--home-assistant"),
                 "--home-assistant: needs a space at a broker"),
                (("robot",), "expected mote, sink, base-station, proxy or FILE.yaml")):
            self.refused(("run", *arguments), text)
        with held_port() as port:
            sink = self.started("sink", "--island", "11", "--radio", f"zep:{port}")
            sink.waits_for(f"rubric: (zep:{port})\n".encode())
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.refused(("run", "sink", "--island", "11", "--radio", "zep:0", "--serial",
                          f"sf-server:{port}"), f"port {port}: Address already in use", 66)

    def test_two_motes_of_one_id_and_a_wrong_call(self):
        one = self.started("mote", "--id", "5", "--radio", "zep:0", "--app", "-")
        air = "zep:" + one.waits_for(rb"zep:(\d+)\n")
        self.started("mote", "--id", "5", "--radio", air)
        self.assertEqual(one.waits_for(rb"has the id (\d+), too"), "5")
        for call in (b"{\n", b"[]\n", b'{"call":"fly"}\n', b'{"call":"start","channel":"2"}\n',
                     b'{"call":"send","dest":"11:70000","app_id":10,"reliable":true,"data":"0"}\n'):
            one.process.stdin.write(call)
            one.process.stdin.flush()
            self.assertEqual(one.lines(1)[0]["event"], "error")
        for call, says in ((b'{"call":"get_clock","x":1}\n', "unknown key 'x'"), (
                b'{"call":"write_output","channel":"1->2","pos":0,"value":1e300}\n',
                "value: expected a number that a float holds")):
            one.process.stdin.write(call)
            one.process.stdin.flush()
            self.assertEqual(one.lines(1)[0], {"event": "error", "text": says})
        one.process.stdin.close()
        self.assertEqual(one.end(None)[0], 0)

    def test_a_full_list_is_told(self):
        motes = "".join(f"      - {{id: {number}}}\n" for number in range(2, 23))
        run = self.started(self.write("islands.yaml", "islands:\n  - island: 11\n    radio: zep:0\n"
                                                      f"    motes:\n{motes}"))
        self.assertEqual(run.waits_for(rb"sink11: its list is full with (\d+) motes"), "20")
        self.assertEqual(run.end()[0], 0)


class Minute(Run):
    """A minute of two islands, which a live check follows."""

    def test_a_minute_is_in_order(self):
        more = "\n".join(f"      - {{id: {id}, app: demo}}" for id in range(20, 24))
        run = self.islands(more, "on")
        air = run.waits_for(rb"island 11: (zep:\d+)")
        watch = Running("check", air)
        self.addCleanup(watch.process.kill)
        end = time.monotonic() + 60
        seen = {}
        while time.monotonic() < end:
            event = run.lines(1)[0]
            kind = (event["node"], event["event"])
            seen[kind] = seen.get(kind, 0) + 1
        watched = watch.end()
        self.assertEqual(watched[0], 0, watched)
        code, _, err = run.end()
        self.assertEqual(code, 0, err)
        self.assertGreater(seen["pc11", "received"], 200)
        self.assertGreater(seen["mote11_5", "received"], 20)
        self.judged(self.folder / "run.pcapng")
        self.judged(self.folder / "run.rtr")


def load_tests(loader, _tests, _pattern):
    """Minute's own test alone is in Minute."""
    suite = unittest.TestSuite(loader.loadTestsFromTestCase(Run))
    return suite


if __name__ == "__main__":
    unittest.main()
