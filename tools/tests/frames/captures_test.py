#!/usr/bin/env python3
"""Captures of the original firmware and base station, through `rubric decode`.

Usage: captures_test.py RUBRIC. Every frame of every capture must decode as the records beside the
capture say, and exactly the frames that were made bad on purpose must be malformed.
"""

import json
import pathlib
import unittest

from readme.number import readme_number
from testing import FIRMWARE, run

CAPTURES = pathlib.Path("spec/captures")
BASE_STATION = CAPTURES / "basestation"

# File: (index, fault, offset in raw, requirement) of each malformed frame; all others have none.
MALFORMED = {
    # A wrong CRC from the host; the pcapng of the scenario has the same frame.
    "h10_hdlc_escape_and_bad_serial.serial_in.bin": [(0, "crc", 11, "WIRE-SERIAL-CRC")],
    "h10_hdlc_escape_and_bad_serial.pcapng": [(7, "crc", 11, "WIRE-SERIAL-CRC")],
    # Injected on the radio: nbytes 100 before four bytes, nbytes 0.
    "h4_stale_bytes.pcapng": [(13, "truncated", 27, "WIRE-NET-PAYLOAD"),
                              (15, "out_of_range", 22, "WIRE-NET-NBYTES")],
    # reliable 2 and 255.
    "s05_reliable_rx.from_sink.sfstream": [(10, "out_of_range", 16, "WIRE-NET-RELIABLE"),
                                           (11, "out_of_range", 16, "WIRE-NET-RELIABLE")],
    # nbytes 0.
    "s06_control_03.from_sink.sfstream": [(0, "out_of_range", 19, "WIRE-NET-NBYTES")],
    "s07_frames.from_sink.sfstream": [
        (1, "truncated", 121, "WIRE-NET-PAYLOAD"),     # Length 0x71: nbytes says one more.
        (2, "truncated", 24, "WIRE-NET-PAYLOAD"),      # Length 0x10.
        (3, "out_of_range", 5, "WIRE-AM-LENGTH"),      # Length 0x73.
        (4, "truncated", 13, "WIRE-R-ADDR"),           # Length 0x05.
        (5, "out_of_range", 5, "WIRE-AM-LENGTH"),      # Length 0xff.
        (7, "unexpected", 0, "WIRE-AM-DISPATCH"),      # Dispatch 0x01.
        (9, "empty", 0, "WIRE-SF-LENGTH"),             # No bytes.
        (10, "truncated", 1, "WIRE-AM-HEADER"),        # The dispatch byte alone.
        (11, "truncated", 7, "WIRE-AM-HEADER"),        # All but the AM type.
    ],
}

def decode(path):
    """The exit code and the lines, parsed."""
    done = run("decode", path, "--format", "jsonl")
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()]


def rows(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def captures():
    suffixes = (".bin", ".pcapng", ".sfstream")
    return sorted(path for path in CAPTURES.glob("*/*") if path.name.endswith(suffixes))


class Captures(unittest.TestCase):
    maxDiff = None

    def test_exactly_the_frames_made_bad_on_purpose_are_malformed(self):
        frames = 0
        for path in captures():
            with self.subTest(path.name):
                code, lines = decode(path)
                frames += len(lines)
                found = [(line["index"], line["error"]["fault"], line["error"]["offset"],
                          line["error"]["requirement"]) for line in lines if line["error"]]
                self.assertEqual(found, MALFORMED.get(path.name, []))
                self.assertEqual(code, 1 if found else 0)
                self.assertEqual([line["index"] for line in lines], list(range(len(lines))))
        self.assertEqual(frames, readme_number("beside it: # frames"))
        self.assertEqual(sum(map(len, MALFORMED.values())), readme_number("purpose, # by the same"))
        names = {path.name for path in captures()}
        self.assertEqual(set(MALFORMED) - names, set())

    def test_radio_frames_agree(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                sent = sorted(
                    (round(row["t_us"] * 1000), row["am_type"], row["src"], row["dst"],
                     row["group"], row["dsn"], row["payload"])
                    for row in rows(path.with_suffix(".radio.jsonl"))
                    if row["dir"] in ("tx", "inj"))
                shown = sorted(
                    (round(line["time"] * 1e9), line["am"]["type"], line["am"]["src"],
                     line["am"]["dest"], line["am"]["group"], line["frame"]["dsn"],
                     line["raw"][22:])
                    for line in decode(path)[1] if line["framing"] == "radio" and line["am"])
                self.assertEqual(shown, sent)
                for line in decode(path)[1]:
                    if line["framing"] == "radio" and line["am"]:
                        self.assertEqual(line["am"]["length"] * 2, len(line["raw"]) - 22)
                        self.assertIsNotNone(line["message"])
                compared += len(sent)
        self.assertGreater(compared, 300)

    def assert_serial(self, line, row):
        """A decoded serial frame against its record; an ACK has no packet."""
        self.assertEqual(line["framing"], "hdlc")
        self.assertEqual(line["frame"]["kind"], row["proto"])
        if "am_type" not in row:  # An ACK: the byte after the kind is what it confirms.
            self.assertIsNone(line["am"])
            self.assertEqual(line["frame"]["serial_seq"], int(row["hdlc"][4:6], 16))
            return
        self.assertEqual(line["frame"]["serial_seq"], row.get("seqno"))
        self.assertEqual(line["raw"], row["sf"])
        wanted = {"dest": row["dst"], "src": row["src"], "length": row["len"],
                  "group": row["group"], "type": row["am_type"]}
        self.assertEqual(line["am"], wanted)

    def test_serial_frames_agree(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                records = rows(path.with_suffix(".sf.jsonl"))
                shown = [line for line in decode(path)[1] if line["framing"] == "hdlc"]
                self.assertEqual(len(shown), len(records))
                for line, row in zip(shown, records):
                    self.assert_serial(line, row)
                    self.assertEqual(round(line["time"] * 1e6), row["t_us"])
                    wanted = "inbound" if row["dir"] == "serial_in" else "outbound"
                    self.assertEqual(line["direction"], wanted)
                    self.assertEqual(line["interface"], f"serial:{row['node']}")
                compared += len(records)
        for path in sorted(FIRMWARE.glob("*.bin")):
            with self.subTest(path.name):
                name, *middle, direction, _ = path.name.split(".")
                node = int(middle[0].removeprefix("node")) if middle else 1
                wanted = "serial_in" if direction == "serial_in" else "serial_out"
                records = [row for row in rows(FIRMWARE / f"{name}.sf.jsonl")
                           if row["dir"] == wanted and row["node"] == node]
                lines = decode(path)[1]
                self.assertEqual(len(lines), len(records))
                for line, row in zip(lines, records):
                    self.assert_serial(line, row)
                compared += len(records)
        self.assertGreater(compared, 400)

    def test_serial_forwarder_packets_agree(self):
        compared = 0
        for path in sorted(BASE_STATION.glob("*.sfstream")):
            with self.subTest(path.name):
                name, direction, _ = path.name.split(".")
                records = [row["hex"] for row in rows(BASE_STATION / f"{name}.sf.jsonl")
                           if row["dir"] == direction]
                self.assertEqual([line["raw"] for line in decode(path)[1]], records)
                compared += len(records)
        self.assertGreater(compared, 60)

    def test_stale_bytes_and_fields_make_up_the_frame(self):
        """Checks the fields of a serial_joined by hand, and that nothing else follows."""
        line = decode(FIRMWARE / "a_join_data.serial.bin")[1][0]
        self.assertEqual(line["message"], "serial_joined")
        self.assertEqual(line["fields"]["payload"]["body"]["transducers"], 0x0043)
        self.assertEqual(line["raw"][:62] + line["stale"], line["raw"])


if __name__ == "__main__":
    unittest.main()
