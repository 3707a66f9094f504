#!/usr/bin/env python3
"""Nothing that comes from outside commands a terminal: names of files, cases and interfaces, texts
of expectations, source lines, options, and what adapters write.

Usage: harmless_test.py RUBRIC
"""
import os
import re
import struct
import unittest

import testing
from packets import interface, packet_block, radio, section
from testing import ROOT

CAPTURE = ROOT / "spec/captures/firmware/b_reliable.pcapng"
CASES = ROOT / "conformance/cases/j2.rtr"
# Colour, a title, a bell, C1 controls in UTF-8 and as bytes, and text that turns round.
EVIL = b"\x1b[31mX\x1b]0;t\x07\xc2\x9b5m\x9b1m\xe2\x80\xae\x7f"
OBEYED = re.compile(rb"[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|\xe2\x80[\xaa-\xae]")
COLOURS = re.compile(rb"\x1b\[[0-9;]*m")


def option(code, value):
    return struct.pack("<HH", code, len(value)) + value + bytes(-len(value) % 4)


def capture():
    """Returns one with an evil name of its interface, and frames that break rules."""
    out = section() + interface(230, option(2, EVIL) + option(0, b""))
    for i in range(9):
        frame = radio(i, 0xFFFF, 2, 14, struct.pack(">HBHB", i, 1, 0x43, 1))
        out += packet_block(i * 1000, frame)
    return out


class Harmless(testing.Folder):
    def write(self, name, data):
        path = os.fsencode(self.folder) + b"/" + name
        with open(path, "wb") as file:
            file.write(data)
        return path

    def shown(self, *words):
        """Returns all output of a command; with colours, without these."""
        text = b""
        for color in ("never", "always"):
            words_now = [*words, "--color", color] if words[0] in (
                "check", "decode", "test") else words
            done = testing.run(*map(os.fsdecode, words_now), timeout=60)
            self.assertGreaterEqual(done.returncode, 0, words)
            out = done.stdout + done.stderr
            text += COLOURS.sub(b"", out.replace(EVIL, b"EVIL")) if color == "always" else out
        return text

    def assert_harmless(self, *words, says=b"X"):
        text = self.shown(*words)
        found = OBEYED.search(text)
        self.assertIsNone(found, (words, found and text[max(0, found.start() - 80):found.end()]))
        self.assertNotIn(b"EVIL", text, words)
        self.assertIn(says, text, words)

    def test_names_of_files(self):
        there = self.write(EVIL + b".pcapng", CAPTURE.read_bytes())
        gone = os.fsencode(self.folder) + b"/gone" + EVIL
        for path in (there, gone):
            for words in (("check", path), ("decode", path, "--format", "text"),
                          ("check", path, path), ("stats", path),
                          ("convert", path, "--format", "hex"),
                          ("check", path, "--verbose")):
                self.assert_harmless(*words, says=b"")
        for words in (("check", gone), ("decode", gone), ("stats", gone),
                      ("decode", "--spec", gone, CAPTURE), ("check", CAPTURE, "--expect", gone),
                      ("check", CAPTURE, "--out", gone + b"/x"),
                      ("convert", CAPTURE, "--format", "pcapng", "-o", gone + b"/x"),
                      ("test", "--target", "machine", gone), ("chart", gone),
                      ("shrink", gone, "--target", "machine"), ("repro", "machine", gone),
                      ("encode", gone), ("check", "--each", gone, there)):
            self.assert_harmless(*words)

    def test_line_ends_in_names(self):
        """A name begins no line of its own."""
        name = b"a\nrubric: b"
        there = self.write(name + b".pcapng", CAPTURE.read_bytes())
        wrong = self.write(name + b".rtr", b"%rtr 1\nx\ny\n")
        gone = self.write(b"gone", b"") + name
        spec = self.write(name + b".ksy", b"meta:\n  id: a\nseq:\n  - id: a\n    type: nothing\n")
        for words in (("check", gone), ("decode", gone), ("check", wrong), ("chart", wrong),
                      ("test", "--target", "machine", wrong), ("encode", there), ("stats", there),
                      ("check", CAPTURE, "--out", gone + b"/x"), ("check", "--expect", gone, there),
                      ("convert", there, "-o", gone + b"/x", "--format", "pcapng"),
                      ("decode", "--spec", spec, there), ("decode", "--spec", there, CAPTURE),
                      ("check", "--" + name.decode()), ("forward", there), ("run", there),
                      ("coverage", "--cases", gone), ("new-adapter", "python", "--out", there),
                      ("check", "--each", CAPTURE, "--resume", there)):
            shown = self.shown(*words)
            self.assertIn(b"rubric: b", shown, words)
            self.assertNotIn(b"\nrubric: b", shown, words)

    def test_words_of_the_command_line(self):
        for words in ((EVIL,), ("check", b"--" + EVIL), ("check", CAPTURE, "--format", EVIL),
                      ("decode", CAPTURE, "--filter", EVIL + b"=="),
                      ("decode", CAPTURE, "--fields", EVIL), ("explain", EVIL),
                      ("test", "--target", "machine", "--cases", EVIL),
                      ("generate", "--message", EVIL), ("forward", EVIL),
                      ("decode", b"serial@/" + EVIL + b":9600"), ("decode", b"sf@" + EVIL + b":1")):
            self.assert_harmless(*words)

    def test_interfaces_of_a_capture(self):
        path = self.write(b"x.pcapng", capture())
        for words in (("decode", path), ("decode", path, "--hex")):
            self.assert_harmless(*words)
        for words in (("stats", path), ("check", path), ("check", path, "--verbose"),
                      ("check", path, path)):
            self.assert_harmless(*words, says=b"")

    def test_source_lines(self):
        for text in (b"%rtr 1\n" + EVIL + b"\n", b"%rtr 1\n# \xc2\x9b5m X\n", EVIL,
                     CASES.read_bytes() + b"\n0 m2 > " + EVIL + b"\n"):
            trace = self.write(b"x.rtr", text)
            for words in (("check", trace), ("test", trace, "--target", "machine"),
                          ("chart", trace)):
                self.assert_harmless(*words, says=b"")
        spec = self.write(b"x.ksy", b"meta:\n  id: a\n  title: \"\\e[31mX\"\nseq:\n  - id: \"" +
                          EVIL + b"\"\n    type: nothing\n")
        self.assert_harmless("decode", "--spec", spec, CAPTURE, says=b"")

    def test_expectations(self):
        found = testing.run("check", CAPTURE, "--format", "json").stdout
        self.assertIn(b'"findings"', found)
        for text in ("J2-NAMES", "J4-SEQ"):
            path = self.write(b"x.yaml", b'- requirement: ' + text.encode() +
                              b'\n  message: "\\e[31mX\\x9b"\n  reason: "\\e]0;t\\aX"\n')
            for words in (("check", CAPTURE, "--expect", path),
                          ("test", "--target", "machine", "--cases", "j2.*", "--expect", path)):
                self.assert_harmless(*words, says=b"")

    def test_adapters(self):
        loud = self.write(b"loud.sh", b"printf '\\033[31mX\\a\\302\\233' >&2\n"
                          b"printf 'rct \\033]0;tX\\a\\n'\n")
        self.assert_harmless("test", "--target", b"sh " + loud, "--cases", "j2.listed")
        self.assert_harmless("test", "--target", b"sh -c 'exit 1' " + EVIL, "--cases",
                             "j2.listed")


if __name__ == "__main__":
    unittest.main()
