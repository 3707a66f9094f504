#!/usr/bin/env python3
"""Captures as sniffers of many makes write them: read as tshark and capinfos read them.

Usage: mixed_captures_test.py RUBRIC.
"""

import gzip
import json
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest
import zlib

from packets import fcs, interface, ipv4, packet_block, radio, section, udp
from testing import ProgramTest, rubric

ZEP_PORT = 17754
NTP_TO_1970 = 2_208_988_800


def frame(number):
    """Returns a frame of BlinkToRadio from mote 1 or 2, I-frame format, without FCS."""
    mote = 1 + number % 2
    return radio(number, 0xFFFF, mote, 6, struct.pack(">HH", mote, number))


def with_fcs(number):
    return frame(number) + fcs(frame(number))


def trailer(number):
    return frame(number) + bytes([(-40 - number % 50) & 0xFF, 0x80 | (100 + number % 8)])


def phy(number):
    return bytes(4) + b"\xa7" + bytes([len(frame(number)) + 2]) + with_fcs(number)


def tlv(kind, value):
    return struct.pack("<HH", kind, len(value)) + value + bytes(-len(value) % 4)


def tap(number):
    facts = tlv(0, b"\1") + tlv(1, struct.pack("<f", -50.5 - number % 30)) + \
        tlv(3, struct.pack("<HB", 11 + number % 16, 0)) + \
        tlv(7, struct.pack("<Q", 10**6 + number)) + tlv(10, bytes([255 - number % 100]))
    return struct.pack("<BBH", 0, 0, 4 + len(facts)) + facts + with_fcs(number)


def zep(number, version=2):
    radio = struct.pack(">BHBB", 15, 7, 1 if version == 1 else 0, 90)
    body = with_fcs(number) if version == 1 else trailer(number)
    if version == 1:
        return b"EX\x01" + radio + bytes(7) + bytes([len(body)]) + body
    return b"EX\x02\x01" + radio + struct.pack(">III", NTP_TO_1970 + 5, 0, number) + bytes(10) + \
        bytes([len(body)]) + body


def ipv6(payload):
    return struct.pack(">IHBB", 6 << 28, len(payload), 17, 64) + bytes(15) + b"\1" + bytes(15) + \
        b"\1" + payload


def ethernet(payload):
    return bytes(12) + b"\x81\0\0\5\x08\0" + payload


def sll(payload):
    return struct.pack(">HHH8sH", 0, 772, 6, bytes(8), 0x0800) + payload


def time_of(number):
    """Microseconds. Some stamps go backwards, as those of a busy USB dongle do."""
    return 1_600_000_000_000_000 + number * 31_250 - (90_000 if number % 17 == 3 else 0)


def pcap(link_type, records, order="<", nano=False, snaplen=65535, time_of=time_of):
    magic = 0xA1B23C4D if nano else 0xA1B2C3D4
    out = struct.pack(order + "IHHIIII", magic, 2, 4, 0, 0, snaplen, link_type)
    for number, record in enumerate(records):
        seconds, part = divmod(time_of(number), 1_000_000)
        kept = record[:snaplen]
        out += struct.pack(order + "IIII", seconds, part * (1000 if nano else 1), len(kept),
                           len(record)) + kept
    return out


def pcapng(interfaces, records):
    """`records` are pairs of an interface's index and its bytes."""
    return section() + b"".join(map(interface, interfaces)) + b"".join(
        packet_block(time_of(number), record, at) for number, (at, record) in enumerate(records))


def some(make, count=60):
    return [make(number) for number in range(count)]


WIFI = bytes.fromhex("00000800 00000000 d4000000 020202020202")
def tap32(number):
    header = struct.pack("<BBH", 0, 0, 12) + tlv(0, b"\2")
    return header + frame(number) + struct.pack("<I", zlib.crc32(frame(number)))


CAPTURES = {
    "dongle.pcap": pcap(195, some(with_fcs)),
    "cc24xx.pcap": pcap(195, some(trailer)),
    "big_endian_ns.pcap": pcap(230, some(frame), ">", True),
    "phy.pcap": pcap(215, some(phy)),
    "tap.pcapng": pcapng([283], [(0, record) for record in some(tap)]),
    "tap32.pcap": pcap(283, some(tap32)),
    "any_zep.pcap": pcap(113, some(lambda n: sll(ipv4(udp(b"query", 53) if n % 5 == 4
                                                      else udp(zep(n)))))),
    "vlan_zep1.pcap": pcap(1, some(lambda n: ethernet(ipv4(udp(zep(n, 1)))))),
    "raw_ipv6_zep.pcap": pcap(101, some(lambda n: ipv6(udp(zep(n))))),
    "short.pcap": pcap(195, some(with_fcs), snaplen=12),
    "ppi.pcap": pcap(192, some(lambda n: struct.pack("<BBHI", 0, 0, 8, 195) + with_fcs(n))),
    "with_wifi.pcapng": pcapng([230, 127], [(n % 2, WIFI if n % 2 else frame(n))
                                            for n in range(60)]),
    "packed.pcap.gz": gzip.compress(pcap(195, some(with_fcs))),
}
FIELDS = ("wpan.src16", "wpan.seq_no", "wpan.rssi", "wpan.correlation", "wpan-tap.rss",
          "wpan-tap.ch_num", "wpan-tap.asn", "wpan-tap.lqi", "zep.channel_id")


class Captures(ProgramTest):
    """Tests with captures in a folder."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)


class Mixed(Captures):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, content in CAPTURES.items():
            (cls.path / name).write_bytes(content)

    def frames(self, name, *args):
        code, out, err = rubric("decode", "--format", "jsonl", *args, self.path / name)
        self.assertEqual(code, 0, (name, err))
        return [json.loads(line) for line in out.splitlines()], err

    def tshark(self, name):
        kind = "TI CC24xx metadata" if name.startswith("cc24xx") else "ITU-T CRC-16"
        args = [word for field in FIELDS for word in ("-e", field)]
        done = subprocess.run(["tshark", "-r", self.path / name, "-o", f"wpan.fcs_format:{kind}",
                               "-Y", "wpan", "-T", "fields", "-e", "frame.number", *args],
                              capture_output=True, check=True, text=True)
        return [dict(zip(("number", *FIELDS), line.split("\t")))
                for line in done.stdout.splitlines()]

    @unittest.skipUnless(shutil.which("tshark"), "no tshark")
    def test_tshark_reads_the_same(self):
        for name in CAPTURES:
            with self.subTest(name):
                mine, _ = self.frames(name, "--fields",
                                      "number,frame.src,frame.dsn,frame.rssi,frame.lqi,"
                                      "frame.channel,frame.slot")
                theirs = self.tshark(name)
                self.assertEqual(len(mine), len(theirs))
                self.assertGreaterEqual(len(mine), 30)
                for one, other in zip(mine, theirs):
                    self.assertEqual(one["number"], int(other["number"]))
                    self.assertEqual(one["frame.dsn"], int(other["wpan.seq_no"]))
                    if one["frame.src"] is not None:
                        self.assertEqual(one["frame.src"], int(other["wpan.src16"], 0))
                    chip = float(other["wpan.rssi"].split()[0]) if other["wpan.rssi"] else None
                    header = float(other["wpan-tap.rss"]) if other["wpan-tap.rss"] else None
                    self.assertEqual(one["frame.rssi"], chip if header is None else header)
                    channel = other["wpan-tap.ch_num"] or other["zep.channel_id"]
                    self.assertEqual(one["frame.channel"], int(channel) if channel else None)
                    lqi = other["wpan-tap.lqi"] or other["wpan.correlation"]
                    if name != "vlan_zep1.pcap":  # ZEP's own, which tshark names otherwise.
                        self.assertEqual(one["frame.lqi"], int(lqi) if lqi else None)
                    slot = other["wpan-tap.asn"]
                    self.assertEqual(one["frame.slot"], int(slot) if slot else None)

    @unittest.skipUnless(shutil.which("capinfos"), "no capinfos")
    def test_capinfos_measures_the_same(self):
        for name in CAPTURES:
            if "zep" in name or "wifi" in name:  # Not all of their packets are frames.
                continue
            done = subprocess.run(["capinfos", "-T", "-M", "-r", "-c", "-u", "-x",
                                   self.path / name], capture_output=True, check=True, text=True)
            _, count, seconds, rate = done.stdout.strip().split("\t")[:4]
            code, out, _ = rubric("stats", "--format", "json", self.path / name)
            self.assertEqual(code, 0)
            stats = json.loads(out)
            self.assertEqual(stats["frames"], int(count), name)
            self.assertAlmostEqual(stats["seconds"], float(seconds), 5)
            self.assertAlmostEqual(stats["frames_per_second"], float(rate), 1)
            self.assertEqual(stats["backward"], 4)
            self.assertEqual(sum(one["frames"] for one in stats["over_time"]["bins"]), 60)

    def test_what_is_left_out_is_said_once(self):
        err = self.frames("any_zep.pcap")[1]
        self.assertEqual(err.count("12 of 60 packets are not ZEP packets (UDP port 17754)"), 1)
        err = self.frames("with_wifi.pcapng")[1]
        self.assertEqual(err.count("link type 127 (802.11 with radiotap header) is not read: 30 of "
                                   "60 packets are left out"), 1)
        alien = self.path / "alien.pcap"
        alien.write_bytes(pcap(127, [WIFI] * 2000))
        code, out, err = rubric("decode", alien)
        self.assertEqual((code, out, err.count("\n")), (NO_INPUT, "", 1))
        self.assertIn("2000 of 2000 packets", err)

    def test_an_fcs_of_32_bits(self):
        self.assertEqual([record["error"] for record in self.frames("tap32.pcap")[0]], [None] * 60)
        broken = bytearray(pcap(283, [tap32(0), tap32(1)]))
        broken[-1] ^= 1
        for name, content, faults in (("tap32.pcap", None, 0), ("broken.pcap", broken, 1)):
            if content:
                (self.path / name).write_bytes(content)
            self.assertIn("or their FCS of 32 bits\n", self.converted(name, faults))

    def test_what_the_sniffer_calls_wrong_stays_wrong(self):
        """Also where the container has no place for the FCS that it had."""
        broken = bytearray(pcap(1, [ethernet(ipv4(udp(zep(number)))) for number in range(3)]))
        broken[-1] &= 0x7F
        (self.path / "broken_zep.pcap").write_bytes(broken)
        self.converted("broken_zep.pcap", 1)

    def converted(self, name, faults):
        """Converts a capture, holds how many frames are malformed, and returns what was said."""
        out = self.path / "converted.pcapng"
        err = rubric("convert", self.path / name, out)[2]
        lines = rubric("decode", "--format", "jsonl", out)[1].splitlines()
        errors = [json.loads(line)["error"] for line in lines]
        self.assertEqual(sum(error is not None for error in errors), faults, name)
        return err

    def test_link_types_by_option(self):
        user = self.path / "user.pcap"
        user.write_bytes(pcap(150, some(with_fcs)))
        self.refused(("decode", user), "--link-type 150=radio-fcs", 66)
        code, out, _ = rubric("decode", user, "--link-type", "150=radio-fcs", "--format", "jsonl")
        self.assertEqual((code, len(out.splitlines())), (0, 60))
        linux = self.path / "linux.pcap"
        linux.write_bytes(pcap(191, some(with_fcs, 30) + some(frame, 30)))
        self.assertEqual(len(self.frames("linux.pcap")[0]), 60)
        for wrong in ("150", "150=", "150=wifi", "146=radio", "15x=radio"):
            self.refused(("decode", user, "--link-type", wrong),
                         "expected a link type from 147 to 162")

    def test_user_link_types_that_are_something_else(self):
        """147 and 148 are taken for ours; where none of their packets is, it is said."""
        for link, what in ((147, "a serial frame"), (148, "an AM packet")):
            name = f"user_{link}.pcap"
            (self.path / name).write_bytes(pcap(link, some(with_fcs)))
            hint = f"none of its packets of link type {link} is sound as {what}"
            err = rubric("decode", self.path / name)[2]
            self.assertEqual((err.count(hint), err.count(f"--link-type {link}=radio-fcs")), (1, 1))
            code, out, err = rubric("decode", self.path / name, "--format", "jsonl", "--link-type",
                                    f"{link}=radio-fcs")
            self.assertEqual((code, len(out.splitlines())), (0, 60))
            self.assertNotIn("sound as", err)
        ours = self.path / "ours.pcap"
        active = b"\0\xff\xff\0\0\4\x22\6\0\2\0\1"
        ours.write_bytes(pcap(148, [active, bytes([9]) + active]))
        self.assertNotIn("sound as", rubric("decode", ours)[2])

    def test_zep_on_other_ports_and_loopbacks_of_bsd(self):
        loops = {0: b"\2\0\0\0", 108: b"\0\0\0\2", 12: b"", 14: b""}
        ack = b"EX\x02\x02" + struct.pack(">I", 1)
        hello = b"EX\x02\xff" + bytes(27) + b"\x08" + bytes(8)
        for link, family in loops.items():
            path = self.path / f"loop{link}.pcap"
            path.write_bytes(pcap(link, [family + ipv4(udp(one, port)) for one, port in
                                         ((zep(1), ZEP_PORT), (zep(2), 17755), (ack, ZEP_PORT),
                                          (hello, 17755), (b"query", 53), (b"EX", 17755))]))
            code, out, err = rubric("decode", path, "--format", "jsonl")
            self.assertEqual((code, [json.loads(line)["raw"] for line in out.splitlines()]),
                             (0, [frame(1).hex(), frame(2).hex()]), err)
            self.assertIn("1 of 6 packets are ZEP acks, which hold no radio frame", err)
            self.assertIn("1 of 6 packets are ZEP hellos of RIOT's nodes, which hold no", err)
            self.assertIn("2 of 6 packets are not ZEP packets", err)

    def test_a_snap_length_is_no_fault_of_the_sender(self):
        frames, _ = self.frames("short.pcap")
        self.assertEqual({one["error"]["text"] for one in frames},
                         {"cut by the capture (12 of 17 bytes)"})
        self.assertEqual({one["error"]["requirement"] for one in frames}, {None})
        text = rubric("decode", self.path / "short.pcap")[1]
        self.assertIn("* cut by the capture (12 of 17 bytes)", text)
        self.assertNotIn("!", text)
        stats = json.loads(rubric("stats", "--format", "json", self.path / "short.pcap")[1])
        self.assertEqual((stats["malformed"], stats["faults"][0]["fault"]), (0, "cut"))

    def test_convert_keeps_facts_or_says_so(self):
        facts = "frame.rssi,frame.lqi,frame.channel,frame.slot,frame.src"
        for name in ("tap.pcapng", "cc24xx.pcap", "any_zep.pcap"):
            wanted = [{**one, "index": 0} for one in self.frames(name, "--fields", facts)[0]]
            for suffix in (".pcapng", ".pcap", ".pcap.gz", ".pcapng.zst"):
                out = self.path / f"out{suffix}"
                code, _, err = rubric("convert", self.path / name, out)
                self.assertEqual(code, 0)
                self.assertNotIn("RSSI, link quality, channel or", err)
                got = self.frames(out, "--fields", facts)[0]
                self.assertEqual([{**one, "index": 0} for one in got], wanted, (name, suffix))
            _, _, err = rubric("convert", self.path / name, self.path / "out.hex")
            self.assertIn("hex holds no RSSI, link quality, channel or time slot", err)
        magic = (self.path / "out.pcapng.zst").read_bytes()[:4]
        self.assertEqual(magic, bytes.fromhex("28b52ffd"))
        packed = (self.path / "out.pcap.gz").read_bytes()
        self.assertEqual(gzip.decompress(packed)[:2], b"\x4d\x3c")

    def test_facts_pass_through_json(self):
        for name, fact in (("tap.pcapng", "slot"), ("cc24xx.pcap", "lqi")):
            lines = rubric("decode", "--format", "jsonl", self.path / name)[1]
            again = rubric("encode", "--spec", "blink_to_radio", "--format", "pcapng", "-o",
                           self.path / "again.pcapng", stdin=lines.encode())
            self.assertEqual(again[0], 0, again[2])
            frames = [one["frame"] for one in map(json.loads, lines.splitlines())]
            self.assertIn(fact, frames[0])
            self.assertEqual([one["frame"] for one in self.frames("again.pcapng")[0]], frames)
        code, _, err = rubric("encode", stdin=lines.encode())
        self.assertEqual(code, 66)
        self.assertIn("; rubicon has no blink_to_radio_msg; blink_to_radio has it: --spec "
                      "blink_to_radio\n", err)

    def test_facts_are_filtered_and_counted(self):
        frames, _ = self.frames("tap.pcapng", "--filter", "frame.channel==12 && frame.rssi < -51")
        self.assertEqual([one["frame"]["channel"] for one in frames], [12] * 4)
        # What the text shows is what a filter takes: a field of RUBICON is called rssi, too.
        shown = self.shows(("decode", "--count", 1, self.path / "tap.pcapng"), " frame.rssi=-50.5 ")
        fact = shown.split()[-1].replace("=", "==")
        self.assertEqual(len(self.frames("tap.pcapng", "--filter", fact)[0]), 1)
        text = rubric("stats", self.path / "tap.pcapng")[1]
        self.assertIn("1>broadcast", text)
        stats = json.loads(rubric("stats", "--format", "json", self.path / "tap.pcapng")[1])
        self.assertEqual([link["rssi"]["max"] for link in stats["links"]], [-50.5, -51.5])
        self.assertEqual(len(stats["channels"]), 16)
        self.assertEqual(stats["sources"][0]["frames"], 30)
        self.assertAlmostEqual(stats["gaps"]["p50"], 0.03125, 3)

    def test_compressed_input_by_its_content(self):
        plain = CAPTURES["dongle.pcap"]
        wanted = rubric("decode", self.path / "dongle.pcap")[1]
        self.assertEqual(rubric("decode", stdin=gzip.compress(plain))[1], wanted)
        whole = gzip.compress(plain)
        packed = self.path / "cut.pcap.zst"
        rubric("convert", self.path / "dongle.pcap", packed)
        for cut in (whole[:len(whole) * 3 // 4], packed.read_bytes()[:-60]):
            code, out, err = rubric("decode", stdin=cut)
            self.assertEqual(code, NO_INPUT)
            self.assertIn(f"stdin: damaged at byte {len(cut)}: its compressed data end too soon",
                          err)
            self.assertEqual(err.count("damaged at byte"), 1)
            frames = [line for line in out.splitlines() if line.startswith(" ")]
            while frames and frames[-1] not in wanted:  # Of a frame that is cut.
                frames.pop()
            self.assertEqual(frames, wanted.splitlines()[:len(frames)])
            if cut in whole:  # zstd has blocks of 128 KiB.
                self.assertGreater(len(frames), 10)
        spoilt = whole[:-6] + bytes([whole[-6] ^ 1]) + whole[-5:]  # The checksum.
        code, out, err = rubric("decode", stdin=spoilt)
        self.assertEqual((code, out), (NO_INPUT, wanted))
        self.assertRegex(err, "damaged at byte [0-9]+: its gzip data are damaged")
        self.refused(("decode", "--follow", self.path / "packed.pcap.gz"), "it is compressed", 66)
        self.assertEqual(rubric("check", self.path / "packed.pcap.gz")[0],
                         rubric("check", self.path / "dongle.pcap")[0])


class Check(Captures):
    """`rubric check` reads what decode reads: of any sniffer the same frames, the same verdict."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        source = "spec/captures/firmware/g2_stray_reply_while_joining.pcapng"
        text = rubric("decode", "--format", "jsonl", "--filter", 'framing=="radio"', source)[1]
        # Eight frames of another PAN and no protocol, by which trailers are recognised.
        others = [(struct.pack("<HBHHHBB", 0x8841, n, 0x77, 0x501, 0x502, 0x3F, 250), n)
                  for n in range(8)]
        cls.frames = others + [(bytes.fromhex(one["raw"]), round(one["time"] * 1000) + 8)
                               for one in map(json.loads, text.splitlines())]

    def capture(self, name, link_type, make):
        records = [make(frame) for frame, _ in self.frames]
        (self.path / name).write_bytes(
            pcap(link_type, records, time_of=lambda number: self.frames[number][1] * 1000))
        return name

    def text(self, name, make, noise=""):
        lines = [make(frame, time_ms) for frame, time_ms in self.frames]
        (self.path / name).write_text(noise + "\n".join(lines) + "\n", encoding="utf-8")
        return name

    def findings(self, name, *args):
        code, out, err = rubric("check", "--format", "json", *args, self.path / name)
        report = json.loads(out)
        return code, [(one["requirement"], one["node"], one["severity"]) for one in
                      report["findings"]], report["counts"]["frames"], err

    def test_the_same_verdict_from_any_sniffer(self):
        wanted = self.findings(self.capture("plain.pcap", 230, lambda frame: frame))
        self.assertEqual(wanted[0], 1)
        self.assertIn("J4-SEQ", [finding[0] for finding in wanted[1]])
        whole = [
            (self.capture("chip.pcap", 195, lambda frame: frame + b"\xd0\xe8"), ()),
            (self.capture("ppi.pcap", 192,
                          lambda frame: b"\0\0\x08\0\xe6\0\0\0" + frame), ()),
            (self.capture("user.pcap", 150, lambda frame: frame), ("--link-type", "150=radio")),
            (self.text("nordic.log", lambda frame, ms: f"received: {frame.hex()}0000 power: -40 "
                       f"lqi: 90 time: {ms}000", "> channel 26\n"), ()),
            (self.text("cooja.txt", lambda frame, ms: f"{ms}\t1\t2\t{len(frame)}: "
                       f"0x{frame.hex(' ', -4)}"), ()),
        ]
        for name, args in whole:
            got = self.findings(name, *args)
            self.assertEqual(got[:3], wanted[:3], (name, got[3]))
        # Without stamps nothing says what came in time.
        name = self.text("bare.txt", lambda frame, ms: (frame + fcs(frame)).hex(), "sniffing\n")
        code, _, frames, err = self.findings(name)
        self.assertEqual((code, frames), (1, wanted[2]))
        self.assertIn("its lines are radio frames with their FCS", err)

    def test_what_is_not_read_is_no_verdict(self):
        name = self.capture("user.pcap", 150, lambda frame: frame)
        self.refused(("check", self.path / name), "--link-type 150=radio-fcs", 66)
        code, out, _ = rubric("check", "--fcs", "crc", self.path / self.capture(
            "chip.pcap", 195, lambda frame: frame + b"\xd0\xe8"))
        self.assertNotIn("J4-SEQ", out)
        self.assertEqual(code, 3)


class Text(ProgramTest):
    BLINK = "00 FF FF 00 00 04 22 06 00 02 00 01"
    # Flags around, the CRC's bytes as a mote sends them.
    SERIAL = "7E 45 00 FF FF 00 00 04 22 06 00 02 00 01 5B 02 7E"

    def decoded(self, text, *args, command="decode"):
        return rubric(command, "--spec", "blink_to_radio", *args, stdin=text.encode())

    def test_logs_of_listen(self):
        log = ("Thread[Thread-1,5,main]serial@/dev/ttyUSB0:115200: resynchronising\n"
               f"{self.BLINK} \nCounter: 7\n\n{self.BLINK}\n")
        code, out, err = self.decoded(log, "--format", "jsonl")
        self.assertEqual((code, len(out.splitlines())), (0, 2), err)
        self.assertIn("2 of its lines hold no packet; the first is line 1", err)

    def test_lines_with_an_unknown_prefix_are_named(self):
        log = f"{self.BLINK}\nhello\nmote1> {self.BLINK}\nmote2> {self.BLINK}\n"
        code, out, err = self.decoded(log, "--format", "jsonl")
        self.assertEqual((code, len(out.splitlines())), (0, 1), err)
        self.assertIn("3 of its lines hold no packet; the first is line 2; line 3 has hex text "
                      "after 'mote1>', which is not a known time stamp", err)

    def test_stamps_of_lines_are_times(self):
        for stamps, times in ((("12:03:04.567", "12:03:05.067"), (43384.567, 43385.067)),
                              (("[123.456]", "[123.5567]"), (123.456, 123.5567)),
                              (("1690000000.123", "1690000001.123"),
                               (1690000000.123, 1690000001.123)),
                              (("12:03:04", "12:03:05"), (None, None))):
            for line in (self.BLINK, self.SERIAL):
                code, out, err = self.decoded("".join(f"{one} {line}\n" for one in stamps),
                                              "--format", "jsonl")
                self.assertEqual((code, err), (0, ""))
                self.assertEqual(tuple(json.loads(one)["time"] for one in out.splitlines()), times)

    def test_marks_of_received_bytes_are_said_once(self):
        for mark in ("rx", "RX:", "<-"):
            code, out, err = self.decoded(f"{mark} {self.BLINK}\n1.001 {mark} {self.SERIAL}\n",
                                          "--format", "jsonl")
            self.assertEqual((code, len(out.splitlines())), (0, 2), err)
            self.assertEqual(err, f"rubric: stdin: '{mark}' before the bytes of its lines is "
                                  "passed over\n")

    def test_mistakes_name_their_line(self):
        for text, where in ((f"{self.BLINK}\n# so far\n00 FF F\n", "line 3, character 8"),
                            (f"hello\n{self.BLINK}\n00 FF 0g\n", "line 3, character 8")):
            code, out, _ = self.decoded(text, "--input-format", "log")
            self.assertEqual(code, 1)
            self.assertIn(where, out)

    def test_bytes_of_a_serial_line_as_text(self):
        halves = self.SERIAL[:20] + "\n" + self.SERIAL[20:]
        for text in (self.SERIAL, halves, f"{self.SERIAL}\n{self.SERIAL}\n"):
            code, out, err = self.decoded(text, "--format", "jsonl")
            self.assertEqual(code, 0, (out, err))
            for line in out.splitlines():
                one = json.loads(line)
                self.assertEqual((one["framing"], one["message"]), ("hdlc", "blink_to_radio_msg"))
        code, out, _ = self.decoded(self.SERIAL[:-8], "--format", "jsonl")
        self.assertEqual((code, json.loads(out)["error"]["fault"]), (1, "cut"))
        self.assertIn("1 frames", self.decoded(self.SERIAL, command="stats")[1])
        self.assertEqual(self.decoded(self.SERIAL, "--format", "hex", command="convert")[1].strip(),
                         self.BLINK)
        self.assertEqual(rubric("check", "-", stdin=self.SERIAL.encode())[0],
                         rubric("check", "-", stdin=self.BLINK.encode())[0])

    def test_sniffers_that_print(self):
        sound = [frame(number) for number in range(9)]
        logs = {
            "nordic": "".join(f"received: {one.hex()}0000 power: -{50 + i} lqi: {i} time: {i}000\n"
                              for i, one in enumerate(sound)),
            "zephyr": "uart:~$ \n" + "".join(f"psdu: {one.hex()} power: -{50 + i} lqi: {i} time: "
                                             f"{i}000\n" for i, one in enumerate(sound)),
            "cooja": "".join(f"{i}\t1\t2,3\t{len(one) + 2}: 0x{(one + fcs(one)).hex(' ', -4)}\n"
                             for i, one in enumerate(sound)),
            "arduino": "Starting capture\n" + "".join(f"{(one + fcs(one)).hex()}\n"
                                                      for one in sound),
        }
        for name, text in logs.items():
            code, out, err = rubric("decode", "--format", "jsonl", stdin=text.encode())
            self.assertEqual(code, 0, (name, err))
            frames = [json.loads(line) for line in out.splitlines()]
            self.assertEqual([one["raw"] for one in frames], [one.hex() for one in sound], name)
            self.assertEqual({one["message"] for one in frames}, {"blink_to_radio_msg"}, name)
            if name != "arduino":
                self.assertEqual([one["time"] for one in frames], [i / 1000 for i in range(9)])
            if name in ("nordic", "zephyr"):
                self.assertEqual([one["frame"]["rssi"] for one in frames],
                                 [-50 - i for i in range(9)])

    def test_what_a_printf_client_prints_is_no_packet(self):
        log = f"{self.BLINK}\nHere is a uint8: 123\n12\ndead beef\nadd 5 motes\n{self.BLINK}\n"
        code, out, err = self.decoded(log, "--format", "jsonl")
        self.assertEqual((code, len(out.splitlines())), (0, 2), err)
        self.assertIn("4 of its lines hold no packet; the first is line 2", err)

    def test_what_is_no_packets_is_refused_with_the_way_out(self):
        dump = "".join(f"0000  {frame(number).hex(' ')}\n" for number in range(3))
        self.refused(("decode",), "text2pcap -l 195", 66, stdin=dump.encode())
        shown = "22866\t1\t-\t 27: 15.4 D 00:12:74:01:00:01:01:01 0xFFFF|IPHC|IPv6|ICMPv6|0000\n"
        self.refused(("decode",), "No Analyzer", 66, stdin=shown.encode())

    def test_radio_frames_as_text(self):
        for kind, make in (("crc", with_fcs), ("cc24xx", trailer)):
            text = "\n".join(make(number).hex() for number in range(9))
            code, out, err = self.decoded(text, "--input-format", "hex-radio", "--fcs", kind,
                                          "--format", "jsonl")
            self.assertEqual((code, len(out.splitlines())), (0, 9), err)
            self.assertEqual("rssi" in json.loads(out.splitlines()[0])["frame"], kind == "cc24xx")


class Specs(ProgramTest):
    def test_it_is_chosen_for_frames_with_trailers(self):
        capture = pcap(195, some(trailer))
        code, out, err = rubric("decode", "--format", "jsonl", stdin=capture)
        self.assertEqual((code, json.loads(out.splitlines()[0])["message"]),
                         (0, "blink_to_radio_msg"), err)

    def test_the_spec_that_fits_is_chosen(self):
        text = Text.BLINK.encode()
        code, out, err = rubric("decode", "--format", "jsonl", stdin=text)
        self.assertEqual((code, json.loads(out)["message"]), (0, "blink_to_radio_msg"))
        self.assertIn("stdin: read by the spec blink_to_radio, which decodes 1 of its first 1 "
                      "messages wholly, rubicon 0", err)
        code, out, err = rubric("decode", "--format", "jsonl", "--spec", "rubicon", stdin=text)
        self.assertEqual(json.loads(out)["message"], "rssi_beacon")
        self.assertIn("AM 6 also fits blink_to_radio: --spec blink_to_radio", err)

    def test_a_capture_of_rubicon_stays_one(self):
        for capture in sorted(pathlib.Path("spec/captures/firmware").glob("*.pcapng")):
            self.assertNotIn("read by the spec", rubric("stats", capture)[2], capture)

    def test_the_spec_that_knows_a_name_is_said(self):
        for args in (("--as", "ctp_data"), ("--filter", "message==ctp_data"),
                     ("--fields", "ctp_data.origin")):
            self.refused(("decode", *args), "; ctp has it: --spec ctp", stdin=b"")

    def test_convert_chooses_packets(self):
        text = (Text.BLINK + "\n" + "00 FF FF 00 00 03 00 25 0A 00 0C\n").encode()
        wanted = Text.BLINK + "\n"
        code, out, _ = rubric("convert", "--format", "hex", "--spec", "blink_to_radio", "--filter",
                              "counter==1", stdin=text)
        self.assertEqual((code, out), (0, wanted))


NO_INPUT = 66

if __name__ == "__main__":
    unittest.main()
