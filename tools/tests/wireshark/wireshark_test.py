#!/usr/bin/env python3
"""Wireshark's dissector against `rubric decode`: every field of every packet, its place and value.

Usage: wireshark_test.py RUBRIC. Needs tshark.
"""

import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import unittest

from testing import FIRMWARE, ROOT, RUBRIC, Folder

# Fields that the dissector adds; not bytes of a field.
ADDED = {"rubric.am_type", "rubric.path", "rubric.message", "rubric.fault", "rubric.fault_offset",
         "rubric.rule", "rubric.stale", "rubric.note", "rubric.malformed"}
FT_NONE, FT_FLOAT = 0, 22  # Of epan/ftypes, as tshark -x prints it.

NO_FCS = 230  # LINKTYPE_IEEE802_15_4_NOFCS
MAC_BYTES, PAN = 9, b"\x22\x00"
NO_RAW = ["", 0, 0, 0, FT_NONE]


def run(*words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, check=False, **more)


def tshark(path, *arguments, script=None):
    script = script or ROOT / "tools/wireshark/generated/rubric.lua"
    done = run("tshark", "-X", f"lua_script:{script}", "-r", path, *arguments)
    errors = done.stderr.decode()
    if done.returncode or "Lua" in errors or b"Lua Error" in done.stdout:
        raise AssertionError(f"{path}: {errors}")
    return done.stdout


def leaves_of(pairs, out):
    """Fields of tshark's JSON that hold a value: name, place, bytes, value, in their order."""
    raw = NO_RAW
    for key, value in pairs:
        if key.endswith("_raw"):
            raw = value
            continue
        if key.endswith("_tree"):
            continue  # Bits of a mask.
        if isinstance(value, list) and value and isinstance(value[0], tuple):
            leaves_of(value, out)
        elif key in ADDED:
            out[1].setdefault(key, []).append((raw, value))
        elif key.startswith("rubric.") and raw[4] != FT_NONE:
            out[0].append((key, raw, value))
        raw = NO_RAW
    return out


def dissected(path, script):
    text = tshark(path, "-T", "json", "-x", script=script).decode()
    packets = json.loads(text, object_pairs_hook=list)
    result = []
    for packet in packets:
        layers = dict(dict(packet)["_source"])["layers"]
        result.append(leaves_of(layers, ([], {})))
    return result


def dumped(path):
    """From `rubric decode --hex`: for each packet the field of each byte, by its last name."""
    text = run(RUBRIC, "decode", path, "--hex", "--color", "never").stdout.decode()
    packets = []
    row = None
    for line in text.splitlines():
        dump = re.match(r"        ([0-9a-f]{4})  [0-9a-f]{2} ", line)
        if re.match(r"[ !*]\s*\d+ ", line[:8]) and not dump:
            packets.append(([], []))
        elif dump:
            row = int(dump[1], 16)
        elif line.startswith("              ") and row is not None:
            marks = [(row + i, line[14 + 3 * i + i // 8:][:1]) for i in range(16)]
            packets[-1][0].extend((at, mark) for at, mark in marks if mark.strip())
            row = None
        elif line.startswith("        ") and packets[-1][0]:
            packets[-1][1].extend(re.findall(r"(\S) (\S+)", line))
    return [named(*packet) for packet in packets]


def named(marks, legend):
    """Marks are used again where a packet has more fields than there are letters: in order."""
    found = {}
    names = iter(legend)
    before = None
    for at, mark in marks:
        if mark == "~":
            found[at] = mark
        elif mark == before:
            found[at] = found[at - 1]
        else:
            letter, name = next(names)
            assert letter == mark, (marks, legend)
            found[at] = name.split(".")[-1]
        before = mark
    return found


def number_of(text):
    return -0.0 if text == "-0" else int(text)


def flat(value):
    """Numbers and opaque bytes of a decoded message, in their order."""
    if isinstance(value, dict):
        for key, one in value.items():
            if not key.endswith(("_name", "_bits")):
                yield from flat(one)
    elif isinstance(value, list):
        for one in value:
            yield from flat(one)
    elif value is not None:
        yield value


def same_value(kind, data, said, wanted):
    """`kind`: Wireshark's number of the type; it shows floats with six digits, so bits count."""
    if kind == FT_FLOAT and not (isinstance(wanted, str) and wanted == data):
        number = float(str(wanted))
        return any(math.isnan(found) and math.isnan(number) or
                   struct.pack("<f", number) == struct.pack("<f", found)
                   for found in struct.unpack("<f", bytes.fromhex(data)) +
                   struct.unpack(">f", bytes.fromhex(data)))
    if isinstance(wanted, str):
        return said.replace(":", "") == wanted == data
    return int(said, 0) == wanted


class Dissector(Folder):
    maxDiff = 3000
    script = None  # The one that ships.

    def pcapng(self, source, *arguments):
        target = self.folder / (pathlib.Path(source).name + ".pcapng")
        done = run(RUBRIC, "convert", source, "-o", target, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return target

    def compare(self, path):
        """Returns how many fields were compared with each other."""
        records = [json.loads(line, parse_int=number_of) for line in
                   run(RUBRIC, "decode", path, "--format", "jsonl").stdout.splitlines()]
        packets = dissected(path, self.script)
        dumps = dumped(path)
        self.assertEqual((len(packets), len(dumps)), (len(records), len(records)))
        compared = 0
        for number, record in enumerate(records):
            if record["message"] == "mac_ack":
                continue  # Wireshark's own.
            with self.subTest(f"{path.name} packet {number + 1}"):
                leaves, added = packets[number]
                compared += self.compare_values(leaves, record)
                self.compare_places(leaves, added, record, dumps[number])
                self.compare_added(added, record)
        return compared

    def compare_values(self, leaves, record):
        wanted = []
        frame = record["frame"]
        if record["framing"] == "hdlc":
            wanted += [frame["kind"], frame["crc"], frame["serial_seq"]]
        if record["framing"] != "radio" and record["am"]:
            keys = ("dest", "src", "length", "group", "type")
            wanted += [0] + [record["am"][key] for key in keys]
        elif record["am"]:
            wanted += [frame["network"], record["am"]["type"]]
        if record["fields"] is None:  # Not decoded further: its header, or what there is of it.
            for name, raw, value in leaves:
                number = int.from_bytes(bytes.fromhex(raw[0]), "big")
                if name not in ("rubric.payload", "rubric.serial.crc"):
                    self.assertEqual(int(value, 0), number, name)
            return len(leaves)
        wanted = [value for value in wanted if value is not None]
        wanted += [value for value in flat(record["fields"]) if value != ""]
        if len(leaves) != len(wanted):  # Texts are made only when needed: they take longest.
            self.fail(f"{leaves}\n{record}")
        for (name, raw, value), right in zip(leaves, wanted):
            if not same_value(raw[4], raw[0], value, right):
                self.fail(f"{name} is {value}, not {right}: {record}")
        return len(wanted)

    def compare_places(self, leaves, added, record, dump):
        """Byte by byte: which field it belongs to."""
        head = 0
        if record["framing"] == "hdlc":
            head = sum(record["frame"][key] is not None for key in ("kind", "serial_seq"))
        found = {}
        shown = [(name.split(".")[-1], raw) for name, raw, _ in leaves
                 if not name.startswith("rubric.serial.")]
        cut = {raw[1] - head: dump.get(raw[1] - head) for name, raw in shown if name == "cut_off"}
        shown = [(cut[raw[1] - head] if name == "cut_off" else name, raw) for name, raw in shown]
        for name, raw in shown + [("~", raw) for raw, _ in added.get("rubric.stale", [])]:
            for at in range(raw[1], raw[1] + raw[2]):
                found[at - head] = name
        mac = 9 if record["framing"] == "radio" else 0  # Wireshark's own, too.
        self.assertEqual(found, {at: name for at, name in dump.items() if at >= mac}, record)

    def compare_added(self, added, record):
        def one(name):
            return added.get("rubric." + name, [(None, None)])[0][1]
        path = record["path"]
        self.assertEqual(one("path"), "/".join(path) if path else None)
        stale = "".join(raw[0] for raw, _ in added.get("rubric.stale", []))
        self.assertEqual(stale, record["stale"])
        error = record["error"]
        self.assertEqual(one("fault"), error and error["fault"])
        self.assertEqual(one("rule"), error and error["requirement"])
        self.assertEqual(one("fault_offset"), error and str(error["offset"]))

    def test_captures(self):
        compared = 0
        for source in sorted((ROOT / FIRMWARE).glob("*.pcapng")):
            compared += self.compare(source)
        for source in sorted((ROOT / "spec/captures").glob("*/*.bin")):
            compared += self.compare(self.pcapng(source, "--input-format", "hdlc"))
        for source in sorted((ROOT / "spec/captures").glob("*/*.sfstream")):
            compared += self.compare(self.pcapng(source, "--input-format", "sf"))
        print(f"{compared} fields compared", file=sys.stderr)
        self.assertGreater(compared, 10000)

    def generated(self, form, count=2000):
        path = self.folder / f"generated.{form}"
        done = run(RUBRIC, "generate", "--count", str(count), "--seed", "1", "--valid", "0.6",
                   "--format", form, "-o", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def test_generated_serial_frames(self):
        """Valid and nearly valid frames of every message, and broken framing."""
        compared = 0
        for form in ("hdlc", "sf"):
            source = self.generated(form)
            compared += self.compare(self.pcapng(source, "--input-format", form))
        self.assertGreater(compared, 20000)

    def test_generated_radio_frames(self):
        """The same on the air, all of them in the PAN that is decoded."""
        path = self.folder / "radio.pcap"
        frames = [json.loads(line) for line in
                  run(RUBRIC, "decode", self.generated("pcapng"), "--format", "jsonl")
                  .stdout.splitlines()]
        with open(path, "wb") as file:
            file.write(struct.pack("<IHHiIII", 0xa1b2c3d4, 2, 4, 0, 0, 65535, NO_FCS))
            for frame in frames:
                raw = bytearray.fromhex(frame["raw"])
                if frame["framing"] == "radio" and len(raw) > MAC_BYTES:
                    raw[3:5] = PAN
                    file.write(struct.pack("<IIII", 0, 0, len(raw), len(raw)) + raw)
        self.assertGreater(self.compare(path), 5000)

    def count(self, *arguments, path=FIRMWARE / "a_join_data.pcapng"):
        return len(tshark(ROOT / path, *arguments).splitlines())

    def shown(self, path):
        """From `rubric decode`: messages and fields of each packet; None where there is none."""
        text = run(RUBRIC, "decode", path, "--color", "never", "--time", "none").stdout.decode()
        records = run(RUBRIC, "decode", path, "--format", "jsonl").stdout.splitlines()
        lines = [line for line in text.splitlines() if not line.startswith("        ")]
        for line, record in zip(lines, map(json.loads, records), strict=True):
            messages = "/".join(record["path"])
            if record["message"] == "mac_ack" or not messages:
                yield None
                continue
            fields = line[line.index(messages):]
            yield re.sub(" +", " ", re.split(r" \+\d+ stale| \* | !! ", fields + " ")[0]).strip()

    def test_info_and_addresses(self):
        """Info says what `rubric decode` says; source and destination are those of the message."""
        compared = 0
        for name in ("a_join_data", "b_reliable", "h10_hdlc_escape_and_bad_serial",
                     "h4_stale_bytes"):
            path = ROOT / FIRMWARE / f"{name}.pcapng"
            columns = [word for one in ("Source", "Destination", "Info")
                       for word in ("-e", f"_ws.col.{one}")]
            found = tshark(path, "-T", "fields", *columns).decode().splitlines()
            records = map(json.loads, run(RUBRIC, "decode", path, "--format", "jsonl")
                          .stdout.splitlines())
            for line, wanted, record in zip(found, self.shown(path), records, strict=True):
                source, destination, info = line.split("\t")
                if wanted is None:
                    continue
                self.assertEqual(info.split(" !! ")[0], wanted)
                am = record["am"]
                self.assertEqual((source, destination), tuple(
                    "Broadcast" if one == 0xffff else f"0x{one:04x}"
                    for one in (am["src"], am["dest"])))
                compared += 1
        self.assertGreater(compared, 150)

    def test_names_for_filters(self):
        self.assertEqual(self.count("-Y", "rubric.join_request"), 3)
        self.assertEqual(self.count("-Y", "rubric.join_request.mote_desc.transducers.temp == 1"), 3)
        wanted = self.count("-Y", "rubric.net_msg.src.devid == 4 && rubric.updates")
        self.assertGreater(wanted, 10)
        self.assertEqual(self.count("-Y", 'rubric.path matches "updates$" && '
                                    "rubric.net_msg.src.devid == 4"), wanted)
        broken = FIRMWARE / "h4_stale_bytes.pcapng"
        self.assertEqual(self.count("-Y", 'rubric.rule == "WIRE-NET-NBYTES"', path=broken), 1)
        self.assertEqual(self.count("-Y", "rubric.malformed", path=broken), 2)

    def test_radio_frames_of_another_pan_are_left_alone(self):
        self.assertGreater(self.count("-Y", "rubric && wpan"), 70)
        self.assertEqual(self.count("-o", "rubric.pan:35", "-Y", "rubric && wpan"), 0)
        self.assertGreater(self.count("-o", "rubric.pan:35", "-Y", "rubric"), 50)

    def test_a_wrong_dissector_is_found(self):
        """The comparison above can fail: a number at another place, a value refused wrongly."""
        source = ROOT / "tools/wireshark/generated/rubric.lua"
        text = source.read_text(encoding="utf-8")
        for right, wrong in (("return true, at + width", "return true, at + 1"),
                             (">= field.min", ">= field.min - 1000"),
                             ("min = 0, max = 114", "min = 0, max = 115"),
                             ("if found == right then", "if true then"),
                             ('"tinyos.am_header"] = {\n  name = "am_header", max = 8',
                              '"tinyos.am_header"] = {\n  name = "am_header", max = 7')):
            self.assertIn(right, text)
            copy = self.write("wrong.lua", text.replace(right, wrong))
            check = Dissector("compare_one")
            check.script = copy
            result = unittest.TestResult()
            result.failfast = True
            check.run(result)
            self.assertFalse(result.wasSuccessful(), wrong)

    def compare_one(self):
        self.compare(ROOT / FIRMWARE / "h4_stale_bytes.pcapng")
        self.compare(self.pcapng(self.generated("hdlc", 500), "--input-format", "hdlc"))

    def test_syntax_of_both_lua_versions(self):
        for luac in ("luac5.2", "luac5.4"):
            done = run(luac, "-p", ROOT / "tools/wireshark/generated/rubric.lua")
            self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
