#!/usr/bin/env python3
"""`rubric encode`, convert, stats, explain and messages as their users meet them.

Usage: commands_test.py RUBRIC.
"""

import json
import os
import pathlib
import re
import struct
import subprocess
import unittest

from packets import fcs
from testing import RUBRIC, Folder, ProgramTest, run, some

CAPTURES = pathlib.Path("spec/captures")
SERIAL = CAPTURES / "firmware/a_join_data.serial.bin"
PCAPNG = CAPTURES / "firmware/a_join_data.pcapng"
BAD_CRC = CAPTURES / "firmware/h10_hdlc_escape_and_bad_serial.serial_in.bin"
STREAM = CAPTURES / "basestation/s07_frames.from_sink.sfstream"

CONFIG = '{"type":"set_island_id","value":12}\n'
CONFIG_PACKET = b"00 FF FF 00 00 03 00 25 0A 00 0C\n"


def rubric(*args, stdin=b""):
    """Exit code, stdout as bytes, stderr as text."""
    done = run(*args, input=stdin.encode() if isinstance(stdin, str) else stdin)
    return done.returncode, done.stdout, done.stderr.decode()


class Contents(Folder):
    """Bytes that a plain Kaitai file says a field always has."""

    def decoded(self, text, stdin, command="decode", *more):
        file = self.write("magics.ksy", text)
        return run(command, "--spec", file, "--as", "magics", *more, input=stdin, text=True)

    def test_three_bytes_are_a_number(self):
        for order in ("be", "le"):
            text = ("meta: {id: magics, endian: le, bit-endian: " + order + "}\nseq:\n"
                    "  - {id: high, type: b8}\n  - {id: magic, contents: [1, 0, 0x41]}\n"
                    "  - {id: last, type: u1}\n")
            found = self.decoded(text, "07 01 00 41 09\n07 41 00 01 09\n", "decode", "--format",
                                 "jsonl")
            whole, wrong = (json.loads(one) for one in found.stdout.splitlines())
            self.assertEqual(whole["fields"], {"high": 7, "magic": 0x010041, "last": 9})
            self.assertEqual((wrong["error"]["fault"], wrong["error"]["offset"]), ("unexpected", 1))
            made = self.decoded(text, '{"high": 7, "magic": 65601, "last": 9}', "encode",
                                "--carrier", "none", "--format", "hex")
            self.assertEqual(made.stdout, "07 01 00 41 09\n", made.stderr)

    def test_they_begin_at_a_byte(self):
        text = ("meta: {id: magics}\nseq:\n  - {id: half, type: b4}\n"
                "  - {id: magic, contents: [1, 2, 3]}\n")
        self.assertIn("the bits 'half' end within a byte", self.decoded(text, "00").stderr)


class Fcs(Folder):
    """Link type 195 with what TI's CC24xx chips write in place of the FCS."""

    def radio_frames(self):
        lines = rubric("decode", "--format", "jsonl", "--filter", "framing==radio", PCAPNG)[1]
        frames = [json.loads(line) for line in lines.splitlines()]
        self.assertGreater(len(frames), 50)
        return [bytes.fromhex(frame["raw"]) for frame in frames]

    def pcap(self, frames, missing=0, link_type=195):
        """Each frame was longer by so many bytes than what was captured."""
        file = self.folder / "sniffed.pcap"
        records = (struct.pack("<4I", i, 0, len(frame), len(frame) + missing) + frame
                   for i, frame in enumerate(frames))
        header = struct.pack("<I2H4I", 0xA1B2C3D4, 2, 4, 0, 0, 65535, link_type)
        file.write_bytes(header + b"".join(records))
        return file

    def trailers(self, frames):
        """RSSI from -60 on, correlation from 90 on, CRC bit set but for the fourth frame."""
        return [frame + bytes((196 + i % 40, (0 if i == 3 else 0x80) + 90 + i % 20))
                for i, frame in enumerate(frames)]

    def test_trailers_are_recognised_and_said_once(self):
        frames = self.radio_frames()
        file = self.pcap(self.trailers(frames))
        code, out, err = rubric("decode", "--format", "csv", "--fields",
                                "raw,error,frame.rssi,frame.lqi", file)
        self.assertEqual((code, err.count("\n")), (1, 1))
        self.assertIn("RSSI", err)
        rows = [line.split(",") for line in out.decode().split("\r\n")[1:-1]]
        self.assertEqual([row[0] for row in rows], [frame.hex() for frame in frames])
        self.assertEqual([i for i, row in enumerate(rows) if row[1]], [3])
        for i, row in enumerate(rows):
            self.assertEqual(row[2:], [str(i % 40 - 60), str(90 + i % 20)], i)
        code, out, _ = rubric("decode", "--filter", "frame.rssi > -50", file)
        self.assertEqual(len(out.splitlines()), sum(i % 40 > 10 for i in range(len(rows))))
        self.assertEqual(rubric("stats", file)[2], err)

    def test_a_conversion_keeps_them(self):
        file = self.pcap(self.trailers(self.radio_frames()))
        again = self.folder / "again.pcap"
        rubric("convert", "--format", "pcap", "-o", again, file)
        self.assertEqual(again.read_bytes()[24:], file.read_bytes()[24:])

    def test_frames_that_were_captured_without_fcs(self):
        """As Contiki's Cooja writes them: the record says that two bytes are missing."""
        frames = self.radio_frames()
        for args in ((), ("--fcs", "none")):
            code, out, err = rubric("decode", "--format", "jsonl", *args, self.pcap(frames, 2))
            shown = [json.loads(line) for line in out.splitlines()]
            self.assertEqual([bytes.fromhex(one["raw"]) for one in shown], frames)
            self.assertEqual((code, {one["error"] for one in shown}), (0, {None}))
            self.assertEqual(err.count("captured without their FCS"), 0 if args else 1)
        self.assertEqual(rubric("check", self.pcap(frames, 2))[1].count(b", 0 rules exercised"), 0)
        for missing in (1, 3):
            out = rubric("decode", "--format", "jsonl", self.pcap(frames, missing))[1]
            self.assertEqual({json.loads(line)["error"]["fault"] for line in out.splitlines()},
                             {"cut"})

    def test_frames_that_end_with_an_fcs_of_which_nothing_is_said(self):
        frames = self.radio_frames()
        ends = [frame + fcs(frame) for frame in frames]
        file = self.pcap(ends, link_type=230)
        code, out, err = rubric("decode", "--format", "jsonl", file)
        shown = [json.loads(line) for line in out.splitlines()]
        self.assertEqual([bytes.fromhex(one["raw"]) for one in shown], frames)
        self.assertEqual((code, {one["stale"] for one in shown}), (0, {""}))
        self.assertEqual(err.count("end with their FCS, though its link type 230"), 1)
        again = self.folder / "again.pcap"
        rubric("convert", "-o", again, file)
        self.assertEqual(again.read_bytes()[24:], file.read_bytes()[24:])
        self.assertEqual(again.read_bytes()[20], 195)
        ends[3] = frames[3]  # By chance a frame without one may end so, but not most of them.
        for few in (ends[:5], ends[:1], frames):
            _, out, err = rubric("decode", "--format", "jsonl", self.pcap(few, link_type=230))
            self.assertEqual([bytes.fromhex(json.loads(line)["raw"]) for line in out.splitlines()],
                             few)
            self.assertNotIn("230", err)

    def test_frames_whose_fcs_is_none(self):
        """As of today's Cooja: nothing says that it is missing."""
        for ends in (b"", b"\xff\xff"):
            file = self.pcap([frame + ends for frame in self.radio_frames()])
            code, _, err = rubric("decode", file)
            self.assertEqual((code, err.count("no FCS of its radio frames fits")), (1, 1), err)
            self.assertIn("--fcs none", err)

    def test_damaged_check_sums_are_not_taken_for_them(self):
        frames = self.radio_frames()
        few = self.trailers(frames)[4:11]
        for name, ends in (("zeros", [frame + bytes(2) for frame in frames]),
                           ("ones", [frame + b"\xff\xff" for frame in frames]),
                           ("seven", few), ("the same one", few[:1] * 50),
                           ("mixed", [frame + bytes((196, 0x80 * (i % 2) + 90))
                                      for i, frame in enumerate(frames)])):
            code, out, err = rubric("decode", "--format", "jsonl", self.pcap(ends))
            faults = {json.loads(line)["error"]["fault"] for line in out.splitlines()}
            self.assertEqual((code, faults), (1, {"fcs"}), name)
            # Seven that are alike are too few to know, but enough to say so.
            self.assertEqual("--fcs cc24xx" in err, name == "seven", err)

    def test_a_choice_is_obeyed(self):
        frames = self.radio_frames()
        file = self.pcap(self.trailers(frames)[4:8])
        self.assertEqual(rubric("decode", "--fcs", "cc24xx", file)[0], 0)
        self.assertEqual(rubric("decode", "--fcs", "crc", file)[0], 1)
        code, out, _ = rubric("decode", "--fcs", "none", "--format", "jsonl", self.pcap(frames))
        self.assertEqual([bytes.fromhex(json.loads(line)["raw"]) for line in out.splitlines()],
                         frames)
        self.assertEqual(code, 0)

    def test_too_many_damaged_frames_are_said(self):
        """As of a sniffer in a busy place: one frame in four fails its CRC."""
        file = self.pcap([frame + bytes((200, (0x80 if i % 4 else 0) + 100))
                          for i, frame in enumerate(self.radio_frames())])
        self.shows(("decode", file), code=1, err="--fcs cc24xx")
        out = rubric("decode", "--fcs", "cc24xx", "--filter", "error", file)[1]
        self.assertEqual(out.count(b"!! fcs at"), (len(self.radio_frames()) + 3) // 4)

    def test_radio_frames_as_text_are_told_from_packets(self):
        lines = "".join(frame.hex(" ") + "\n" for frame in self.radio_frames())
        for words in ((), ("--input-format", "log"), ("--input-format", "hex")):
            err = rubric("decode", *words, stdin=lines)[2]
            self.assertEqual(err.count("if they are radio frames: --input-format hex-radio"), 1)
        self.assertEqual(rubric("decode", "--input-format", "hex-radio", stdin=lines)[::2], (0, ""))
        packet = CONFIG_PACKET.decode()
        self.assertEqual(rubric("decode", stdin=packet + lines)[2].count("hex-radio"), 0)

    def test_text_without_packets(self):
        for text, parted in ((b"Booted\nhello\n", False), (b"0x00, 0xff, 0xff, 0x00\n", True),
                             (b"00:ff:ff:00:00:03:00:25:0a:00:0c\n", True)):
            for words in (("decode",), ("stats",)):
                code, _, err = rubric(*words, stdin=text)
                self.assertEqual(code, 66)
                self.assertIn("no line of this text is a packet in hex digits", err)
                self.assertEqual("tr ',:-' ' '" in err, parted, err)

    def test_an_empty_file_is_named(self):
        file = self.folder / "empty.pcap"
        file.touch()
        for words in (("decode", file), ("stats", file), ("encode", file),
                      ("convert", file, "-o", os.devnull, "--format", "hex")):
            code, _, err = rubric(*words)
            self.assertEqual((code, err), (0, f"rubric: {file}: is empty\n"), words)

    def test_texts_of_windows(self):
        packet = "00 FF FF 00 00 03 00 25 0A 00 0C\r\n"
        expected = rubric("decode", stdin=packet.encode())
        self.assertEqual(expected[0], 0)
        for text in (packet, "# note\r\n" + packet):
            self.assertEqual(rubric("decode", stdin=b"\xef\xbb\xbf" + text.encode()), expected)
        self.refused(("decode",), "this is UTF-16 text", 66, stdin=packet.encode("utf-16"))
        line = b'\xef\xbb\xbf{"type":10,"value":12}\r\n'
        self.assertEqual(rubric("encode", "--as", "config", stdin=line),
                         (0, b"00 FF FF 00 00 03 00 25 0A 00 0C\n", ""))
        self.refused(("encode",), "; --as MESSAGE reads the fields of a message alone", 66,
                     stdin=line)


class Encode(Folder):
    def decoded(self, *files):
        return rubric("decode", "--format", "jsonl", *files)[1]

    def test_streams_come_back_byte_for_byte(self):
        for file in sorted(CAPTURES.glob("basestation/*.sfstream")):
            code, out, err = rubric("encode", "--format", "sf", stdin=self.decoded(file))
            self.assertEqual((code, err), (0, ""), file)
            self.assertEqual(out, file.read_bytes(), file)

    def test_fields_alone(self):
        self.assertEqual(rubric("encode", "--as", "config", stdin=CONFIG), (0, CONFIG_PACKET, ""))
        code, out, _ = rubric("encode", "--as", "config", "--format", "hdlc", "--dest", "0x1",
                              stdin=CONFIG)
        self.assertEqual(code, 0)
        self.assertEqual(out[1:12].hex(), "4500000100000300250a00"[:22])
        code, out, _ = rubric("encode", "--as", "config", "--carrier", "none", stdin=CONFIG)
        self.assertEqual((code, out), (0, b"0A 00 0C\n"))
        reply = '{"island_addr":11,"mote_addr":2,"cur_time":258,"seq_num":7}'
        code, out, _ = rubric("encode", "--as", "join_reply", "--format", "pcapng", stdin=reply)
        code, out, _ = rubric("decode", "--format", "jsonl", stdin=out)
        frame = json.loads(out)
        self.assertEqual((frame["message"], frame["fields"]["seq_num"], frame["error"]),
                         ("join_reply", 7, None))

    def test_other_lines_go_on_after_a_bad_one(self):
        file = self.folder / "in.jsonl"
        file.write_text(CONFIG + "\n" + '{"type":1,"value":70000}\n' + "{oops}\n" + CONFIG)
        code, out, err = rubric("encode", "--as", "config", file)
        self.assertEqual((code, out), (66, 2 * CONFIG_PACKET))
        first, second = err.splitlines()
        self.assertEqual(first, f"rubric: {file}:3: value: expected a number from 0 to 65535, "
                                "given 70000 (WIRE-CONFIG)")
        self.assertTrue(second.startswith(f"rubric: {file}:4:"), second)
        err = rubric("encode", stdin="00 ffff 0000")[2]
        self.assertIn("stdin:1:2: hex digits, no JSON; 'rubric convert' reads frames as hex", err)

    def test_fields_changed_beside_raw(self):
        line = json.loads(self.decoded(SERIAL).splitlines()[0])
        line["fields"]["seq_num"] = 9
        code, out, err = rubric("encode", stdin=json.dumps(line))
        self.assertEqual((code, out), (66, b""))
        self.assertIn('stdin:1: fields.seq_num: given 9, but "raw" says 0; delete "raw"', err)
        del line["raw"]
        self.refused(("encode",), 'delete "crc" to have it computed', 66, stdin=json.dumps(line))
        del line["frame"]["crc"]
        code, out, err = rubric("encode", "--format", "hdlc", stdin=json.dumps(line))
        self.assertEqual((code, err), (0, ""))
        code, out, _ = rubric("decode", "--format", "jsonl", stdin=out)
        self.assertEqual((code, json.loads(out)["fields"]["seq_num"]), (0, 9))

    def test_what_a_container_cannot_hold(self):
        code, _, err = rubric("encode", "--format", "hex", stdin=self.decoded(BAD_CRC))
        self.assertEqual(code, 66)
        self.assertIn("hex holds no malformed frames: ", err)
        # Cut when it was captured: on a serial line its last bytes would read as a CRC.
        cut = {"schema": "rubric.decode/1", "framing": "hdlc", "raw": "00ffff00000300250a000c",
               "frame": {"kind": 69, "dropped": 4}, "error": {"fault": "cut"}}
        for container, expected in [("pcapng", 0), ("hdlc", 66)]:
            code, _, err = rubric("encode", "--format", container, stdin=json.dumps(cut))
            self.assertEqual(code, expected, err)
        self.assertIn("4 bytes of this frame were dropped", err)

    def test_usage(self):
        for args, says in [
            (["--as", "confg"], "did you mean 'config'?"),
            (["--as", "updates"], "no AM type carries updates itself"),
            (["--format", "xml"], "--format"),
            (["--dest", "1"], "go with --as MESSAGE"),
            (["--spec", "rubicn"], "did you mean 'rubicon'?"),
        ]:
            self.refused(("encode", *args), says)

    def test_never_overwrites_what_it_reads(self):
        file = self.write("x.jsonl", CONFIG)
        for args in [[file], ["-"], []]:
            with open(file, "rb") as stdin:
                done = subprocess.run([RUBRIC, "encode", "--as", "config", *args, "-o", file],
                                      stdin=stdin, capture_output=True)
            self.assertEqual(done.returncode, 64, args)
            self.assertIn(b"is also an input", done.stderr)
            self.assertEqual(file.read_text(), CONFIG)

    def test_a_folder_that_is_not_there(self):
        self.assertEqual(rubric("encode", "-o", "/nonexistent/x", stdin="")[0], 74)


class Convert(Folder):
    def test_to_pcapng_and_back_to_the_line(self):
        pcapng, back = self.folder / "x.pcapng", self.folder / "x.bin"
        self.assertEqual(rubric("convert", SERIAL, pcapng), (0, b"", ""))
        self.assertEqual(rubric("convert", pcapng, back)[0], 0)
        self.assertEqual(back.read_bytes(), SERIAL.read_bytes())

    def test_pcapng_keeps_everything(self):
        again = self.folder / "x.pcapng"
        self.assertEqual(rubric("convert", PCAPNG, again), (0, b"", ""))
        self.assertEqual(rubric("decode", again)[1], rubric("decode", PCAPNG)[1])

    def test_frames_without_times_stay_without(self):
        again = self.folder / "x.pcapng"
        self.assertEqual(rubric("convert", SERIAL, again), (0, b"", ""))
        lines = [json.loads(line) for line in
                 rubric("decode", again, "--format", "jsonl")[1].splitlines()]
        self.assertEqual({line["time"] for line in lines}, {None})
        err = rubric("convert", SERIAL, "-o", self.folder / "x.pcap")[2]
        self.assertRegex(err, r"rubric: (\d+) of \1 packets have no time stamp and got 0, as pcap")
        # Of the second interface a pcapng cannot say it.
        err = rubric("convert", PCAPNG, SERIAL, "-o", self.folder / "both.pcapng")[2]
        self.assertIn("have no time stamp and got that of the packet before them", err)

    def test_says_what_is_lost(self):
        code, out, err = rubric("convert", PCAPNG, "--format", "hex")
        self.assertEqual((code, len(out.splitlines())), (0, 151))
        for what in ["holds no times", "holds no directions", "holds no interface names",
                     "does not say which lines are radio frames"]:
            self.assertIn(what, err)
        self.shows(("convert", PCAPNG, "-o", self.folder / "x.pcap"),
                   err="left out 71 of 151 packets: pcap holds one link type")
        code, _, err = rubric("convert", PCAPNG, "-o", self.folder / "x.sf")
        self.assertIn("left out 80 of 151 packets: sf holds no radio frames", err)
        code, _, err = rubric("convert", BAD_CRC, "--format", "sf")
        self.assertIn("sf holds no malformed frames", err)

    def test_only(self):
        pcap = self.folder / "x.pcap"
        code, _, err = rubric("convert", PCAPNG, pcap, "--only", "hdlc")
        self.assertEqual(code, 0)
        self.assertNotIn("left out", err)
        self.assertEqual(len(rubric("decode", pcap)[1].splitlines()), 71)

    def test_usage(self):
        self.assertEqual(rubric("convert", SERIAL, "--format", "xml")[0], 64)
        self.assertEqual(rubric("convert", SERIAL, self.folder / "x.xyz")[0], 64)
        copy = self.write("x.bin", SERIAL.read_bytes())
        with open(copy, "rb") as stdin:
            done = subprocess.run([RUBRIC, "convert", "-o", copy], stdin=stdin, capture_output=True)
        self.assertEqual(done.returncode, 64)
        self.assertEqual(copy.read_bytes(), SERIAL.read_bytes())
        self.refused(("convert", SERIAL, "-o", "", "--format", "sf"), "--out: is empty")

    def test_a_shorter_capture_replaces_a_longer_one(self):
        target = self.write("x.bin", 3 * SERIAL.read_bytes())
        self.assertEqual(rubric("convert", SERIAL, target)[0], 0)
        self.assertEqual(target.read_bytes(), SERIAL.read_bytes())


class Stats(unittest.TestCase):
    def test_agrees_with_decode(self):
        for file in some(sorted([*CAPTURES.glob("firmware/*.pcapng"),
                                 *CAPTURES.glob("basestation/*.sfstream")])):
            frames = [json.loads(line)
                      for line in rubric("decode", "--format", "jsonl", file)[1].splitlines()]
            code, out, _ = rubric("stats", "--format", "json", file)
            stats = json.loads(out)
            malformed = sum(1 for frame in frames if frame["error"])
            self.assertEqual(stats["schema"], "rubric.stats/1")
            self.assertEqual((stats["frames"], stats["malformed"]), (len(frames), malformed), file)
            self.assertEqual(code, 1 if malformed else 0)
            self.assertEqual(sum(m["frames"] for m in stats["messages"]), len(frames))
            self.assertEqual(sum(f["frames"] for f in stats["faults"]), malformed)
            for row in stats["messages"]:
                named = sum(1 for frame in frames if frame["message"] == row["message"])
                self.assertEqual(row["frames"], named or row["frames"])

    def test_text(self):
        code, out, _ = rubric("stats", STREAM)
        self.assertEqual(code, 1)
        for what in ["message", "source>destination", "fault", "WIRE-AM-DISPATCH"]:
            self.assertIn(what, out.decode())
        self.assertEqual(rubric("stats", "/nonexistent")[0], 66)


class Explain(ProgramTest):
    def test_names(self):
        for name, says in [
            ("net_msg", "WIRE-NET-NBYTES"),
            ("wire-net-nbytes", "so it is 2 to 102"),
            ("transducer_mask", "0x1000  rssi5"),
            ("component", "control_layer"),
            ("am_header", "WIRE-AM-DISPATCH"),
            ("J4-SEQ", "Otherwise in release 1.0"),
            ("J8-FAIL", "Accepted by --profile deployed"),
        ]:
            code, out, err = rubric("explain", name)
            self.assertEqual((code, err), (0, ""), name)
            self.assertIn(says, out.decode())
        self.shows(("explain", "--spec", "oscilloscope", "oscilloscope_msg"), "AM 147 on serial")

    def test_a_group_of_rules(self):
        code, out, err = rubric("explain", "j4")
        self.assertEqual((code, err), (0, ""))
        heads = [line.split(":")[0] for line in out.decode().splitlines()
                 if line and not line.startswith(" ")]
        catalogue = pathlib.Path("spec/requirements.yaml").read_text()
        self.assertEqual(heads, re.findall(r"(?m)^- id: (J4-\S+)", catalogue))
        self.assertEqual(rubric("explain", "J4-SEQ")[1].decode().count("Source: "), 1)

    def test_every_case_is_found_from_its_rule(self):
        rules = set()
        for file in pathlib.Path("conformance/cases").rglob("*.rtr"):
            name = None
            for line in file.read_text().splitlines():
                line = line.split(";")[0]
                if line.startswith("case "):
                    name = line.split()[1]
                for tag in re.findall(r"\)\s*\[([A-Z][^\]]*)\]", line):
                    for rule in re.split(r"[\s,]+", tag.strip()):
                        rules.add((rule, "!>" in line.split(), name))
        self.assertTrue(rules)
        text = {rule: rubric("explain", rule, "--cases")[1].decode().split("Cases:")[1]
                for rule in some(sorted({rule for rule, _, _ in rules}))}
        for rule, negative, name in sorted(rules):
            if rule not in text:
                continue
            positives, _, negatives = text[rule].partition("negative:")
            found = negatives if negative else positives
            self.assertIn(name, re.findall(r"(\S+) \(", " ".join(found.split())), rule)

    def test_every_rule_names_the_places_where_it_is(self):
        catalogue = pathlib.Path("spec/requirements.yaml").read_text()
        levels = dict(re.findall(r"(?m)^- id: (\S+)\n  level: (\S+)", catalogue))
        code, out, err = rubric("explain", *levels)
        self.assertEqual((code, err), (0, ""))
        places = {}  # Of each rule, by part: the line in each file.
        for text in out.decode().split("\n\n"):
            block = re.search(r"  In the code:\n((?:    .*\n?)*)", text)[1]
            words = re.split(r"\s*(sentence|wire spec|codec|machine|flaws|checker): ", block)[1:]
            places[text.split(":")[0]] = {
                part: dict(place.split(":") for place in re.split(r",\s+", found.strip()))
                for part, found in zip(words[::2], words[1::2]) if not found.startswith("never by")}
        self.assertEqual(places.keys(), levels.keys())
        parts_of = {"conformance/machine": ("machine", "flaws"), "conformance/check": ("checker",)}
        for folder, parts in parts_of.items():  # Nothing is left out, ...
            for path in pathlib.Path(folder).rglob("*.*"):
                if path.suffix in {".cc", ".h"} and "test" not in str(path):
                    for pair in re.findall(r'//= ([A-Z][\w-]+):|"([\w-]+)"_rule',
                                           path.read_text()):
                        named = [places["".join(pair)].get(part, {}) for part in parts]
                        self.assertTrue(any(str(path) in found for found in named), pair)
        for rule, level in levels.items():  # and what is named is there.
            if not rule.startswith("WIRE-"):
                self.assertIn("machine", places[rule], rule)
            for found in places[rule].values():
                for file, line in found.items():
                    lines = pathlib.Path(file).read_text().splitlines()
                    self.assertRegex(lines[int(line) - 1], rf"\b{rule}\b")
            self.assertEqual(places[rule].pop("sentence").keys(), {"spec/requirements.yaml"})
            if level == "MUST" and not places[rule]:
                self.assertIn(".rtr)", rubric("explain", rule)[1].decode(), rule)

    def test_what_is_reported_in_place_of_a_rule(self):
        page = pathlib.Path("conformance/check/README.md").read_text(encoding="utf-8")
        rows = re.findall(r"(?m)^\| ([\w, -]+) \| (.*) \|$", page.split("that are never named")[1])
        self.assertGreater(len(rows), 5)
        for rules, instead in rows[1:]:
            for rule in rules.split(", "):
                out = " ".join(rubric("explain", rule)[1].decode().split())
                self.assertIn(f"checker: never by this name; in its place: {instead} ", out)

    def test_a_name_that_nothing_has(self):
        code, _, err = rubric("explain", "NOPE")
        self.assertEqual(code, 64)
        self.assertTrue(err.startswith("rubric explain: nothing is called 'NOPE'"), err)
        err = rubric("explain", "README.md")[2]
        self.assertIn("'README.md' is a file; 'rubric decode' prints its frames", err)

    def test_long_lists_of_cases_are_cut(self):
        out = rubric("explain", "J1-REQUEST")[1].decode()
        more = re.search(r"(\d+) more: rubric explain J1-REQUEST --cases", " ".join(out.split()))
        whole = rubric("explain", "J1-REQUEST", "--cases")[1].decode()
        self.assertNotIn(" more: ", whole)
        self.assertGreater(whole.count(".rtr"), int(more[1]))
        self.assertLess(len(out.splitlines()), 20)

    def test_frames_of_the_radio_as_traces_write_them(self):
        """rct/1 has radio frames in a serial packet's form, so that is what people paste."""
        for hexadecimal, name, field in [
                ("00 ffff 0001 06 00 0e 03e802000701", "join_request", "mote_desc.mote_type"),
                ("00 0005 0001 0a 00 0f 000b00050000000003e8", "join_reply", "cur_time"),
                ("00 0001 0005 0e 00 1d 000b0001000b000503e802000701", "ack_join", "seq_num")]:
            code, out, _ = rubric("explain", hexadecimal)
            self.assertEqual(code, 0)
            self.assertIn(f"{name} does not travel on the serial line",
                          " ".join(out.decode().split()))
            self.assertIn(field, out.decode())
            self.assertNotIn(b"Opaque", out)
            code, lines, _ = rubric("decode", "--input-format", "hex", "--format", "jsonl",
                                    stdin=hexadecimal.encode() + b"\n")
            line = json.loads(lines)
            self.assertEqual((code, line["message"]), (0, name))
            self.assertEqual(line["notes"][0]["note"], "radio_only")
            for missing in [(), ("raw",)]:  # Fields alone give the same bytes.
                kept = {key: value for key, value in line.items() if key not in missing}
                code, back, err = rubric("encode", "--format", "hex",
                                         stdin=json.dumps(kept).encode())
                self.assertEqual((code, err), (0, ""))
                self.assertEqual(bytes.fromhex(back.decode()), bytes.fromhex(hexadecimal))

    def test_frames(self):
        self.shows(("explain", *CONFIG_PACKET.decode().split()), "set_island_id")
        self.shows(("explain", "--as", "config", "0a000c"), "the message config alone")
        self.shows(("explain", "--as", "config", "0a00"), "WIRE-CONFIG (MUST)", code=1)

    def test_unknown(self):
        for args, says in [(["net_mesg"], "did you mean 'net_msg'?"),
                           (["NET_MSG"], "did you mean 'net_msg'?"),
                           (["J4-SEK"], "did you mean 'J4-SEQ'?"),
                           (["N99"], "groups of rules are WIRE, N1, "),
                           (["j4-none"], "rules of J4 are J4-ACK, "),
                           (["WIRES"], "did you mean 'WIRE'?"),
                           (["99887766"], "begin like no frame"),
                           (["--framing", "sf", "xyz"], "expected hex digits"),
                           (["net_msg", "upates"], "did you mean 'updates'?")]:
            self.refused(("explain", *args), says)


class Simulate(ProgramTest):
    def test_a_seed_has_no_sign(self):
        for seed in ("-1", "0x7", "1.5"):
            self.refused(("simulate", "--seconds", "1", "--seed", seed),
                         f"--seed: expected a whole number of 0 or more, given '{seed}'")
        self.assertEqual(rubric("simulate", "--seconds", "1", "--seed", str(2**64 - 1))[0], 0)


class Stats(Folder):
    def test_a_rate_needs_a_second(self):
        join = CAPTURES / "firmware/a_join_data.pcapng"
        lines = rubric("decode", join, "--format", "jsonl")[1].splitlines(keepends=True)
        for count, says in ((len(lines), "10.22 frames/s over 14.773 s"), (2, "within 0.008835 s")):
            path = self.folder / "first.pcapng"
            rubric("encode", "--format", "pcapng", "-o", path, stdin=b"".join(lines[:count]))
            out = self.shows(("stats", path), f"0 malformed, {says}")
            self.assertEqual("frames/s" in out, count > 2, out)


class Messages(ProgramTest):
    def test_text_and_json(self):
        code, out, _ = rubric("messages")
        self.assertEqual(code, 0)
        text = out.decode()
        listed = json.loads(rubric("messages", "--format", "json")[1])
        self.assertEqual(listed["schema"], "rubric.messages/1")
        for message in listed["messages"]:
            self.assertIn(f" {message['id']} ", text)
        net_msg = next(m for m in listed["messages"] if m["id"] == "net_msg")
        self.assertEqual((net_msg["am_types"], net_msg["min_size"], net_msg["max_size"]),
                         ([28], 14, 114))
        self.assertLessEqual(max(map(len, text.splitlines())), 110)
        self.assertRegex(text, r"(?m)^35  updates .* app_msg ")
        self.shows(("messages", "--spec", "oscilloscope"), "oscilloscope_msg")
        self.assertEqual(rubric("messages", "--spec", "nothing")[0], 64)


if __name__ == "__main__":
    unittest.main()
