#!/usr/bin/env python3
"""Radio frames over ZEP: `zep:PORT` as a line in use, and what Wireshark reads.

Usage: zep_test.py RUBRIC. All of it on this host's loopback, bounded in time.
"""

import json
import re
import select
import shutil
import socket
import struct
import subprocess
import time
import unittest

from packets import fcs, interface, ipv4, packet_block, section, udp
from live_testing import LiveTest, lines_of
from serial_testing import PATIENCE_S

RADIO = "spec/captures/firmware/g2_stray_reply_while_joining.pcapng"
NTP_TO_1970 = 2_208_988_800


def zep(frame, number=1, device=2, channel=26, seconds=1000.5):
    stamp = (NTP_TO_1970 + int(seconds), int(seconds % 1 * (1 << 32)))
    return b"EX\x02\x01" + struct.pack(">BHBBIII", channel, device, 1, 255, *stamp, number) \
        + bytes(10) + bytes([len(frame)]) + frame


def radio_frames():
    records = [record for record in lines_of(RADIO, "--hex") if record["framing"] == "radio"]
    return [bytes.fromhex(record["raw"]) for record in records], records


class Station:
    def __init__(self, test, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        test.addCleanup(self.socket.close)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(("127.0.0.1", port))

    def send(self, datagram):
        try:
            self.socket.send(datagram)
        except ConnectionRefusedError:  # Nobody is there now.
            pass


class Zep(LiveTest):
    def hub(self, *arguments):
        running = self.started(*arguments)
        said = b""
        deadline = time.monotonic() + PATIENCE_S
        while not said.endswith(b"\n"):
            left = max(0, deadline - time.monotonic())
            self.assertTrue(select.select([running.process.stderr], [], [], left)[0])
            said += running.process.stderr.read1(1)
        return running, int(re.fullmatch(rb"rubric: zep:(\d+)\n", said).group(1))

    def test_frames_are_decoded_and_kept(self):
        kept = self.folder / "kept.pcapng"
        running, port = self.hub("decode", "zep:0", "--format", "jsonl", "--write", kept)
        frames, wanted = radio_frames()
        station = Station(self, port)
        for number, frame in enumerate(frames):
            station.send(zep(frame + fcs(frame), number))
        records = running.lines(len(frames))
        self.assertEqual([record["fields"] for record in records],
                         [record["fields"] for record in wanted])
        self.assertEqual({record["interface"] for record in records}, {"zep:0"})
        self.assertLess(abs(records[0]["time"] - time.time()), PATIENCE_S)
        station.send(zep(frames[0] + bytes(2)))
        station.send(b"EX\x03\x01")
        faults = [record["error"]["requirement"] for record in running.lines(2)]
        self.assertEqual(faults, ["WIRE-RADIO-FCS", "WIRE-ZEP"])
        self.assertEqual(running.end()[0], 1)
        self.assertEqual(len(lines_of(kept)), len(frames) + 2)

    def test_a_node_hears_its_channel(self):
        _, port = self.hub("run", "sink", "--island", "11", "--radio", "zep:0")
        station = Station(self, port)
        for dsn, channel in ((7, 11), (8, 26)):  # Data for mote 1, which are to be confirmed.
            frame = bytes.fromhex(f"6188{dsn:02x}2200010005003f06")
            station.send(zep(frame + fcs(frame), device=5, channel=channel))
        self.assertEqual(station.socket.recv(128)[32:35], bytes.fromhex("020008"))

    def test_a_node_keeps_frames_in_the_order_in_which_it_takes_them(self):
        kept = self.folder / "kept.pcapng"
        sink, port = self.hub("run", "sink", "--island", "11", "--radio", "zep:0", "--write", kept)
        station = Station(self, port)
        now = time.time()
        # The stamps of motes 5 and 6 say another order. That of one for mote 9 holds.
        for mote, dest, late in ((5, 1, 0), (6, 1, 0.02), (7, 9, 0.05)):
            frame = bytes.fromhex(f"6188{mote:02x}2200{dest:02x}00{mote:02x}003f1c"
                                  f"000bfffd000b00{mote:02x}00000703030a55")
            station.send(zep(frame + fcs(frame), device=mote, seconds=now - late))
            if dest == 1:  # What waits together is taken by its stamps.
                self.assertEqual(station.socket.recv(128)[32:35], bytes([2, 0, mote]))
        time.sleep(0.5)
        self.assertEqual(sink.end()[0], 0)
        times = {record["frame"]["src"]: record["time"] for record in lines_of(kept)
                 if record["message"] != "mac_ack"}
        self.assertLess(times[5], times[6])
        self.assertLess(times[7], times[5])

    def test_a_hub_passes_frames_on_and_another_takes_its_place(self):
        hub, port = self.hub("decode", "zep:0", "--format", "jsonl")
        listener = self.started("decode", f"zep:{port}", "--format", "jsonl")
        frame = radio_frames()[0][0]
        station = Station(self, port)
        for end_hub in (True, False):
            deadline = time.monotonic() + PATIENCE_S
            # Until the listener is known to the hub, or is the hub.
            while not select.select([listener.process.stdout], [], [], 0.05)[0]:
                self.assertLess(time.monotonic(), deadline)
                station.send(zep(frame + fcs(frame)))
            record = listener.lines(1)[0]
            self.assertEqual(record["message"], "join_request")
            if end_hub:
                self.assertEqual(hub.end()[0], 0)
                while select.select([listener.process.stdout], [], [], 0.2)[0]:
                    listener.lines(1)
        self.assertEqual(listener.end()[0], 0)

    def test_check_judges_them(self):
        running, port = self.hub("check", "zep:0", "--format", "jsonl")
        station = Station(self, port)
        for frame in radio_frames()[0]:
            station.send(zep(frame + fcs(frame)))
        while "J4-SEQ" not in running.text_lines(1)[0]:
            pass
        self.assertEqual(running.end()[0], 1)

    def test_a_serial_line_is_wanted_where_packets_are_sent(self):
        for command in (("forward", "zep:17754"), ("send", "--to", "zep:17754")):
            self.refused(command, "expected serial@DEVICE:BAUD")
        self.refused(("decode", "zep:x"), "expected zep:PORT")

    @unittest.skipUnless(shutil.which("tshark"), "no tshark")
    def test_wireshark_reads_the_same(self):
        frame = radio_frames()[0][0]
        packet = ipv4(udp(zep(frame + fcs(frame), 0x01020304, 0x0102)))
        path = self.write("zep.pcapng", section() + interface(101) + packet_block(0, packet))
        run = subprocess.run(["tshark", "-r", path, "-T", "json", "-J", "zep wpan"],
                             capture_output=True, check=True)
        layers = json.loads(run.stdout)[0]["_source"]["layers"]
        text = json.dumps(layers["zep"])
        self.assertEqual(int(layers["zep"]["zep.version"]), 2, text)
        self.assertEqual(int(layers["zep"]["zep.channel_id"]), 26)
        self.assertEqual(int(layers["zep"]["zep.device_id"], 0), 0x0102)
        self.assertEqual(int(layers["zep"]["zep.seqno"]), 0x01020304)
        self.assertEqual(int(layers["zep"]["zep.length"]), len(frame) + 2)
        self.assertIn("00:16:40.5", layers["zep"]["zep.time"])
        self.assertEqual(layers["wpan"]["wpan.fcs_ok"], "1")
        self.assertEqual(int(layers["wpan"]["wpan.src16"], 0), 2)


if __name__ == "__main__":
    unittest.main()
