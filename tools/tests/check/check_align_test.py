#!/usr/bin/env python3
"""`rubric check` of the air and a line that were recorded apart.

Usage: check_align_test.py RUBRIC in the project's folder.
"""

import json
import re
import struct
import unittest

from testing import FIRMWARE, Folder, rubric

EPOCH_S = 1_500_000_000


def report(*args):
    return json.loads(rubric("check", "--format", "json", *args)[1])


def shifted(pcap, ahead_ns):
    """A pcap file with nanoseconds whose stamps are later."""
    out = bytearray(pcap)
    at = 24
    while at < len(out):
        seconds, ns, size = struct.unpack_from("<III", out, at)
        seconds, ns = divmod(seconds * 10**9 + ns + ahead_ns, 10**9)
        struct.pack_into("<II", out, at, seconds, ns)
        at += 16 + size
    return bytes(out)


def names(one):
    """Findings without the places, which are of other files."""
    return sorted((f["requirement"] or "", f["severity"], f["node"] or "",
                   re.sub(r"frame \d+", "frame", f["text"]))
                  for f in one["findings"])


class Apart(Folder):
    def path(self, name):
        return self.folder / name

    def split(self, capture, ahead_s):
        """The air by the clock of a computer, the line by that of another one."""
        for name, only in (("air.pcap", "radio"), ("line.pcap", "hdlc"), ("line.bin", "hdlc")):
            rubric("convert", capture, "--only", only, "-o", self.path(name))
        for name, start_s in (("air.pcap", EPOCH_S), ("line.pcap", EPOCH_S + ahead_s)):
            path = self.path(name)
            path.write_bytes(shifted(path.read_bytes(), round(start_s * 10**9)))
        return self.path("air.pcap"), self.path("line.pcap"), self.path("line.bin")

    def test_the_report_is_that_of_the_whole(self):
        for name in ("a_join_data", "h4_stale_bytes"):
            capture = FIRMWARE / f"{name}.pcapng"
            for ahead_s in (-3600, -1.5, 0.2, 1_000_000):
                for swapped in (False, True):
                    with self.subTest(name, ahead_s=ahead_s, swapped=swapped):
                        files = self.split(capture, ahead_s)[:2]
                        apart = report(*(reversed(files) if swapped else files))
                        self.assertEqual(names(apart), names(report(capture)))
                        self.said(apart["facts"], -ahead_s if swapped else ahead_s)

    def said(self, facts, ahead_s):
        fact = next(f for f in facts if " is aligned with " in f)
        said = re.search(r"by (\d+) common frames: its clock is ([\d.]+) s (ahead|behind) "
                         r"\(spread [\d.]+ ms\)$", fact)
        self.assertTrue(said, fact)
        self.assertGreaterEqual(int(said[1]), 3)
        self.assertAlmostEqual(float(said[2]) * (1 if said[3] == "ahead" else -1), ahead_s,
                               delta=0.03)

    def test_clocks_that_agree_are_left_alone(self):
        air, line, _ = self.split(FIRMWARE / "a_join_data.pcapng", 0.01)
        self.assertFalse([f for f in report(air, line)["facts"] if "aligned" in f])

    def test_off_takes_stamps_as_they_are(self):
        air, line, raw = self.split(FIRMWARE / "a_join_data.pcapng", -3600)
        apart = report("--align", "off", air, line)
        self.assertFalse([f for f in apart["facts"] if "aligned" in f])
        self.assertNotEqual(names(apart), names(report(air, line)))
        self.assertFalse([f for f in report("--align", "off", air, raw)["facts"] if "order" in f])

    def test_bytes_without_stamps_are_in_order(self):
        air, _, raw = self.split(FIRMWARE / "a_join_data.pcapng", 0)
        facts = report(air, raw)["facts"]
        self.assertTrue([f for f in facts if re.search(
            r"line\.bin, which has no time stamps, is in order with .*air\.pcap by \d+ common "
            r"frames, between which \d+ of its \d+ frames lie$", f)], facts)

    def test_the_text_says_why_not(self):
        air = self.split(FIRMWARE / "b_reliable.pcapng", 0)[0]
        air = air.rename(self.path("other.pcap"))
        line = self.split(FIRMWARE / "a_join_data.pcapng", 5)[1]
        out = rubric("check", air, line)[1]
        self.assertIn("is not aligned with", " ".join(out.split()))


if __name__ == "__main__":
    unittest.main()
