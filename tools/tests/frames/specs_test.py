#!/usr/bin/env python3
"""Tests `--spec`: shipped specs with their vectors, files, mistakes, and the word on other specs.

Usage: specs_test.py RUBRIC; run in the project's folder.
"""

import json
import os
import pathlib
import re
import resource
import tempfile
import unittest

from odd_specs import FLOATING, UNPROVED
from testing import Folder, ProgramTest, run, sanitized, some

BLINK = "00 FF FF 00 00 04 22 06 00 02 00 01"
BEACON = "00 FF FF 00 00 01 22 06 07"
PLAIN = """meta:
  id: plain
  endian: be
types:
  pair:
    seq:
      - id: a
        type: u1
      - id: b
        type: u2
"""


TEXTS = """meta: {id: texts, endian: be, encoding: UTF-8, file-extension: txt}
seq:
  - {id: version, type: b4}
  - {id: flag, type: b1}
  - {id: rest, type: b19}
  - {id: name, type: str, size: 8, terminator: 0, encoding: ascii}
  - {id: label, type: strz, -orig-id: Label}
  - {id: opt, type: u2, if: flag}
  - {id: kind, type: u1, if: version == 4}
  - {id: tail, type: str, size-eos: true}
"""


def little_memory():
    if not sanitized():
        resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))


def rubric(*args, stdin=""):
    return run(*args, input=stdin, text=True)


def vectors():
    """Returns the spec, bytes, message and fields of each vector."""
    path = pathlib.Path("spec/vectors/run_time.jsonl")
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


class Shipped(ProgramTest):
    def test_every_vector_decodes_and_encodes(self):
        for one in some(vectors()):
            with self.subTest(**one):
                way = one.get("as", "hex")
                done = rubric("decode", "--spec", one["spec"], "--format", "jsonl",
                              "--input-format", way, stdin=one["hex"])
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                frame = json.loads(done.stdout)
                self.assertEqual((frame["message"], frame["fields"], frame["notes"]),
                                 (one["message"], one["fields"], []))
                del frame["raw"]
                with tempfile.NamedTemporaryFile(suffix=".pcapng") as capture:
                    again = rubric("encode", "--spec", one["spec"], "--format", "pcapng", "-o",
                                   capture.name, stdin=json.dumps(frame))
                    self.assertEqual(again.returncode, 0, again.stderr)
                    back = rubric("decode", "--spec", one["spec"], "--format", "jsonl",
                                  capture.name)
                self.assertEqual(json.loads(back.stdout)["raw"],
                                 one["hex"].replace(" ", "").lower())

    def test_every_message_has_a_vector(self):
        listed = rubric("decode", "--spec", "list").stdout
        names = [line.split()[0] for line in listed.splitlines()]
        self.assertEqual(names[:2], ["oscilloscope", "rubicon"])
        there = {(one["spec"], one["message"]) for one in vectors()}
        for file in sorted(pathlib.Path("spec/wire/run_time").glob("*.ksy")):
            self.assertIn(file.stem, names)
            cases = re.search(r"cases: &messages\n((?:        .*\n)+)", file.read_text()).group(1)
            for message in re.findall(r": (\w+)", cases):
                self.assertIn((file.stem, message), there)

    def test_what_is_no_spec(self):
        for name, says in [("spec", "'spec' is a folder"), ("README.md", "does not end with .ksy"),
                           ("oscilloscop", "(did you mean 'oscilloscope'?)")]:
            self.refused(("decode", "--spec", name), says, stdin=BLINK)

    def test_generated_frames_decode_as_expected(self):
        for spec in ("blink_to_radio", "ctp", "dissemination", "ftsp", "printf", "none"):
            made = rubric("generate", "--spec", spec, "--count", "60", "--valid", "0.5",
                          "--seed", "7", "--format", "hex")
            said = rubric("generate", "--spec", spec, "--count", "60", "--valid", "0.5",
                          "--seed", "7", "--format", "hex", "--expect", "/dev/stderr").stderr
            expected = [json.loads(x)["verdict"] for x in said.splitlines() if x.startswith("{")]
            done = rubric("decode", "--spec", spec, "--format", "jsonl", stdin=made.stdout)
            found = ["malformed" if json.loads(x)["error"] else "valid"
                     for x in done.stdout.splitlines()]
            self.assertEqual(len(expected), 60)
            self.assertEqual(found, expected, spec)

    def test_generated_beacons_and_commands_decode_as_expected(self):
        made = rubric("generate", "--spec", "ieee802154", "--message", "beacon", "--message",
                      "command", "--count", "400", "--valid", "0.6").stdout
        made = [json.loads(x) for x in made.splitlines()]
        self.assertEqual({x["carrier"] for x in made}, {"radio_beacon", "radio_command"})
        done = rubric("decode", "--spec", "ieee802154", "--input-format", "hex-radio", "--format",
                      "jsonl", stdin="".join(x["raw"] + "\n" for x in made)).stdout
        found = [json.loads(x) for x in done.splitlines()]
        for one, frame in zip(made, found, strict=True):
            with self.subTest(**one):
                wanted, got = one["error"], frame["error"]
                if got is None:
                    self.assertEqual((one["verdict"], one["path"]), ("valid", frame["path"]))
                else:
                    self.assertEqual((wanted["fault"], wanted["offset"]),
                                     (got["fault"], got["offset"]))


class OtherSpecs(unittest.TestCase):
    def said(self, line, *args, command="decode"):
        return rubric(command, *args, stdin=line).stderr

    def test_a_message_that_fits_another_spec_better_is_named_once(self):
        hint = "rubric: AM 6 also fits blink_to_radio: --spec blink_to_radio\n"
        self.assertEqual(self.said(f"{BLINK}\n{BLINK}\n", "--spec", "rubicon"), hint)
        self.assertEqual(self.said(BLINK, "--spec", "rubicon", command="stats"), hint)
        self.assertEqual(rubric("explain", *BLINK.split()).stderr, hint)
        self.assertEqual(self.said(BLINK, "--spec", "ctp"),
                         "rubric: AM 6 fits blink_to_radio: --spec ctp,blink_to_radio\n")

    def test_beacons_and_commands_are_named_once(self):
        beacon = "00 80 07 AA 1A 01 00 FF CF 00 00\n"
        hint = "rubric: a beacon fits ieee802154: --spec rubicon,ieee802154\n"
        self.assertEqual(self.said(2 * beacon, "--input-format", "hex-radio"), hint)
        self.assertEqual(self.said("08 80 07 AA 1A 01 00 FF CF 00 00",  # Secured.
                                   "--input-format", "hex-radio"), "")

    def test_what_fits_or_fits_nothing_is_passed_over(self):
        self.assertEqual(self.said(BLINK, "--spec", "blink_to_radio"), "")
        self.assertEqual(self.said(BLINK, "--spec", "none"), "")
        self.assertEqual(self.said(BEACON), "")
        self.assertEqual(self.said(BLINK.replace("06", "FA")), "")


class Several(Folder):
    """One capture, in which motes speak more than one protocol."""

    CTP = "00 FF FF 00 02 0A 22 70 01 05 80 00 01 00 0A 00 03 FF"
    OWN = "00 FF FF 00 00 03 22 2A 00 05 50"

    def messages(self, spec, *lines, more=(), hint=""):
        done = rubric("decode", "--spec", spec, "--format", "jsonl", *more,
                      stdin="".join(line + "\n" for line in lines))
        self.assertEqual((done.returncode, done.stderr), (0, hint))
        return [json.loads(line)["message"] for line in done.stdout.splitlines()]

    def lamp(self):
        return str(self.write(
            "lamp.ksy", "meta: {id: lamp, endian: be}\ntypes:\n  lamp_state:\n    -am-type: 42\n"
            "    seq: [{id: lamp, type: u2}, {id: level, type: u1}]\n"))

    def test_each_message_by_the_first_that_has_its_type(self):
        lines = (self.CTP, BLINK, self.OWN)
        lamp = self.lamp()
        mine = self.folder / "mine.ksy"
        mine.write_text("meta: {id: mine, endian: be}\ntypes:\n  mine:\n    -am-type: 0x70\n"
                        "    seq: [{id: all, size-eos: true}]\n")
        self.assertEqual(self.messages(f"rubicon,blink_to_radio,ctp,{lamp},{mine}", *lines),
                         ["ctp_routing", "blink_to_radio_msg", "lamp_state"])
        self.assertEqual(self.messages(f"{mine},{lamp},ctp,blink_to_radio", *lines),
                         ["mine", "blink_to_radio_msg", "lamp_state"])
        self.assertEqual(
            self.messages(f"rubicon,{lamp}", *lines,
                          hint="rubric: AM 112 fits ctp: "
                          f"--spec rubicon,{lamp},ctp\nrubric: AM 6 also fits blink_to_radio: "
                          "--spec blink_to_radio\n")[1:], ["rssi_beacon", "lamp_state"])
        self.assertEqual(self.messages("ctp", self.CTP, self.OWN, more=("--spec", lamp)),
                         ["ctp_routing", "lamp_state"])

    def test_a_capture_of_one_reads_the_same(self):
        for capture in some(sorted(pathlib.Path("spec/captures/firmware").glob("[gh]*.pcapng"))):
            one, both = (rubric("decode", str(capture), "--format", "jsonl", "--spec", spec)
                         for spec in ("rubicon", "rubicon,ctp,printf"))
            self.assertEqual((both.returncode, both.stdout), (one.returncode, one.stdout))

    def test_radio_frames_and_beacons(self):
        beacon = "00 80 07 AA 1A 01 00 FF CF 00 00"
        radio = "41 88 01 22 00 FF FF 02 00 3F 70 01 05 80 00 01 00 0A 00 03 FF"
        self.assertEqual(self.messages("rubicon,ieee802154,ctp", beacon, radio,
                                       more=("--input-format", "hex-radio")),
                         ["beacon", "ctp_routing"])

    def test_the_other_commands(self):
        both = "oscilloscope,ctp"
        listed = rubric("messages", "--spec", both).stdout
        for name in ("oscilloscope_msg", "ctp_data"):
            self.assertRegex(listed, name)
        said = rubric("stats", "--spec", both, stdin=self.CTP).stdout
        self.assertIn("ctp_routing", said)
        explained = rubric("explain", "--spec", both, *self.CTP.split())
        self.assertIn("ctp_routing", explained.stdout)
        frame = rubric("decode", "--spec", both, "--format", "jsonl", stdin=self.CTP).stdout
        record = json.loads(frame)
        del record["raw"]
        made = rubric("encode", "--spec", both, "--format", "hex", stdin=json.dumps(record))
        self.assertEqual(made.stdout.split(), self.CTP.split(), made.stderr)

    def test_generated_frames_decode_as_expected(self):
        for both in ("rubicon,blink_to_radio,ctp", "blink_to_radio,rubicon", "ctp,printf"):
            made = rubric("generate", "--spec", both, "--count", "200", "--valid", "0.5").stdout
            made = [json.loads(x) for x in made.splitlines()]
            serial = [x for x in made if x["carrier"] == "serial"]
            done = rubric("decode", "--spec", both, "--format", "jsonl",
                          stdin="".join(x["raw"] + "\n" for x in serial)).stdout
            self.assertGreater(len(serial), 30)
            for one, frame in zip(serial, map(json.loads, done.splitlines()), strict=True):
                with self.subTest(both=both, **one):
                    self.assertEqual(one["error"] is None, frame["error"] is None)
                    if one["verdict"] == "valid":
                        self.assertEqual(one["path"], frame["path"])

    def test_what_is_none(self):
        for spec, says in [("ctp,rubico", "unknown protocol 'rubico' (did you mean 'rubicon'?)"),
                           ("ctp,spec", "'spec' is a folder")]:
            self.refused(("decode", "--spec", spec), says, stdin=BLINK)
        odd = self.folder / "odd.ksy"
        odd.write_text("meta: {id: odd, endian: be}\n-carrier: serial\nseq:\n"
                       "  - {id: head, type: u1}\n  - {id: kind, type: u1}\n"
                       "  - {id: body, size-eos: true, type: {switch-on: kind, cases: {1: a}}}\n"
                       "types: {a: {seq: [{id: a, type: u1}]}}\n")
        done = rubric("decode", "--spec", f"ctp,{odd}", stdin=BLINK)
        self.assertEqual(done.returncode, 64)
        self.assertIn("odd has the messages of serial frames, or the number that chooses one, in "
                      "another place than ctp", done.stderr)

    def test_a_name_with_a_comma_is_a_file_if_there_is_one(self):
        file = self.write("my,own.ksy", PLAIN)
        done = rubric("decode", "--spec", str(file), "--as", "pair", stdin="01 00 02\n")
        self.assertIn("a=1 b=2", done.stdout)


class File(Folder):
    def file(self, text, name="plain.ksy"):
        return str(self.write(name, text))

    def test_a_file_decodes_like_the_built_in_spec(self):
        for capture in some(sorted(pathlib.Path("spec/captures/firmware").glob("[gh]*.pcapng"))):
            for output in ("text", "jsonl", "csv"):
                args = ["decode", str(capture), "--format", output]
                built_in = rubric(*args)
                read = rubric(*args, "--spec", "spec/wire/rubicon.ksy")
                self.assertTrue(built_in.stdout)
                self.assertEqual((read.returncode, read.stdout),
                                 (built_in.returncode, built_in.stdout))

    def test_a_spec_needs_no_rules(self):
        mine = PLAIN.replace("    seq:", "    -requirement: WIRE-MINE\n    seq:")
        for text in (PLAIN, mine):
            self.assert_works(self.file(text))

    def assert_works(self, file):
        done = rubric("decode", "--spec", file, "--as", "pair", stdin="01 00 02\n01\n")
        self.assertEqual(done.returncode, 1)
        lines = done.stdout.splitlines()
        self.assertIn("a=1 b=2", lines[0])
        self.assertIn("truncated at 1", lines[1])
        listed = rubric("messages", "--spec", file).stdout
        self.assertIn("pair", listed)
        self.assertIn("b", rubric("explain", "--spec", file, "pair").stdout)
        line = rubric("encode", "--spec", file, "--as", "pair", "--carrier", "none",
                      "--format", "hex", stdin='{"a":1,"b":2}')
        self.assertEqual(line.stdout.split(), ["01", "00", "02"], line.stderr)

    def test_parameters_lists_and_other_encodings_are_written_as_they_are_read(self):
        for name in ("lists", "computed", "wide"):
            args = ["--spec", f"spec/kaitai_check/{name}.ksy"]
            made = rubric("generate", *args, "--message", name, "--count", "60").stdout
            raw = "".join(json.loads(line)["raw"] + "\n" for line in made.splitlines())
            read = rubric("decode", *args, "--as", name, "--format", "jsonl", stdin=raw).stdout
            sound = [line for line in read.splitlines() if json.loads(line)["error"] is None]
            self.assertGreater(len(sound), 20)
            again = rubric("encode", *args, "--format", "hex", stdin="\n".join(sound))
            self.assertEqual([line.replace(" ", "").lower() for line in again.stdout.splitlines()],
                             [json.loads(line)["raw"] for line in sound], again.stderr)

    def test_what_a_condition_ends_is_cut_or_written_wrongly(self):
        text = ("meta: {id: ends}\nseq: [{id: list, type: u1, repeat: until, "
                "repeat-until: _ == 0}]\n")
        args = ["--spec", self.file(text, "ends.ksy"), "--as", "ends"]
        shown = rubric("decode", *args, stdin="01 02\n01 00\n01 00 03\n").stdout.splitlines()
        self.assertIn("truncated at 2", shown[0])
        self.assertIn("list=[1 0]", shown[1])
        self.assertIn("list=[1 0] +1 stale", shown[2])
        for given, wrong in (('[1]', "element 0 is the last, and does not end the list"),
                             ('[0,1]', "element 0 ends the list, and others follow"),
                             ('[]', "expected an element or more")):
            done = rubric("encode", *args, "--carrier", "none", stdin=f'{{"list":{given}}}')
            self.assertEqual(done.returncode, 66)
            self.assertIn(wrong, done.stderr)

    def test_a_parameter_that_its_type_does_not_hold_is_a_fault(self):
        text = ("meta: {id: calls}\nseq: [{id: n, type: u1}, {id: a, type: 'part(n - 2)'}]\n"
                "types: {part: {params: [{id: m, type: u1}], seq: [{id: b, size: m}]}}\n")
        args = ["--spec", self.file(text, "calls.ksy"), "--as", "calls"]
        done = rubric("decode", *args, stdin="03 AA\n01\n")
        self.assertIn("a{b=aa}", done.stdout)
        self.assertIn("truncated at 1", done.stdout.splitlines()[-1])
        self.assertIn("can be beyond 'm'; each frame is checked", done.stderr)
        alone = rubric("decode", *args[:2], "--as", "part", stdin="01\n")
        self.assertEqual(alone.returncode, 64)
        self.assertIn("part has parameters, which the type around it gives", alone.stderr)

    def test_text_and_bits_are_shown_and_written(self):
        args = ["--spec", self.file(TEXTS, "texts.ksy"), "--as", "texts"]
        line = "4ABCDE 6162000000000000 68C3A400 AABB 07 6869"
        escape = "48BCDE 6162001B41000000 68FF00 1B5B 22"
        shown = rubric("decode", *args, stdin=line).stdout
        self.assertIn('version=4 flag=1 rest=179422 name="ab" label="hä" opt=43707 kind=7 '
                      'tail="hi"', shown)
        shown = rubric("decode", *args, "--filter", "name=='ab' && error", stdin=escape).stdout
        self.assertNotIn("\x1b", shown)
        self.assertEqual("", shown)
        both = rubric("decode", *args, "--format", "jsonl", stdin=f"{line}\n{escape}").stdout
        frames = [json.loads(x) for x in both.splitlines()]
        self.assertEqual(frames[0]["fields"], {
            "version": 4, "flag": 1, "rest": 179422, "name": "ab", "label": "hä", "opt": 43707,
            "kind": 7, "tail": "hi"})
        self.assertEqual(frames[1]["fields"]["name_hex"], "6162001b41000000")
        self.assertEqual([x["note"] for x in frames[1]["notes"]], ["not_text"])
        for frame in frames:
            del frame["raw"]
        made = rubric("encode", "--spec", args[1], "--format", "hex",
                      stdin="".join(json.dumps(x) + "\n" for x in frames))
        self.assertEqual([x.replace(" ", "") for x in made.stdout.splitlines()],
                         [line.replace(" ", ""), escape.replace(" ", "")], made.stderr)
        frames[1]["fields"]["name"] = "cd"
        made = rubric("encode", "--spec", args[1], stdin=json.dumps(frames[1]))
        self.assertIn("name_hex says", made.stderr)
        columns = rubric("decode", *args, "--format", "csv", "--fields", "name,tail",
                         stdin=line.replace("6869", "3D1B2C"))
        self.assertEqual(columns.stdout.splitlines()[1], 'ab,"=\ufffd,"')
        self.assertIn("Only if flag", rubric("explain", *args[:2], "texts").stdout)

    def test_text_is_read_and_written_as_generated(self):
        args = ["--spec", self.file(TEXTS, "texts.ksy")]
        expect = self.folder / "expect"
        made = rubric("generate", *args, "--count", "500", "--valid", "0.5", "--format", "hex",
                      "--expect", str(expect)).stdout
        done = rubric("decode", *args, "--as", "texts", "--format", "jsonl", stdin=made).stdout
        wanted = [json.loads(x)["error"] for x in expect.read_text().splitlines()]
        frames = [json.loads(x) for x in done.splitlines()]
        self.assertEqual(len(frames), 500)
        for error, frame in zip(wanted, frames):
            found = frame["error"]
            self.assertEqual(error and (error["fault"], error["offset"]),
                             found and (found["fault"], found["offset"]))
            del frame["raw"]
        sound = [x for x in frames if not x["error"]]
        self.assertGreater(len(sound), 100)
        again = rubric("encode", *args, "--format", "hex",
                       stdin="".join(json.dumps(x) + "\n" for x in sound)).stdout
        bytes_of = [x for x, error in zip(made.splitlines(), wanted) if not error]
        self.assertEqual(again.splitlines(), bytes_of)

    def test_what_cannot_be_proved_is_noted_and_checked(self):
        file = self.file(UNPROVED, "unproved.ksy")
        lines = "04 01 AABB 01 02 0001 0002 00\n03 02 AA 01 0007\n02 09\n01 01 05\n09 01 05\n"
        done = rubric("decode", "--spec", file, "--as", "unproved", "--format", "jsonl",
                      stdin=lines)
        self.assertIn(f"{file}:5:29: note: the size 'length - 2' can be negative; each frame is "
                      "checked\n", done.stderr)
        self.assertIn("note: instance 'twice' is computed; it is not shown\n", done.stderr)
        self.assertNotIn("error", done.stderr)
        frames = [json.loads(x) for x in done.stdout.splitlines()]
        self.assertEqual(frames[0]["fields"], {
            "length": 4, "kind": 1, "body": "aabb",
            "chosen": {"default": 1, "default_name": "red", "empty": {}},
            "lists": [{"count": 2, "values": [1, 2]}, {"count": 0, "values": []}]})
        self.assertEqual(frames[1]["fields"]["chosen"], {"count": 1, "values": [7]})
        self.assertEqual(frames[2]["fields"], {"length": 2, "kind": 9, "body": "", "lists": []})
        self.assertEqual([x["error"] and (x["error"]["fault"], x["error"]["offset"])
                          for x in frames], [None, None, None, ("truncated", 3), ("truncated", 3)])
        for frame in frames:
            del frame["raw"]
        again = rubric("encode", "--spec", file, "--format", "hex",
                       stdin="".join(json.dumps(x) + "\n" for x in frames[:3]))
        self.assertEqual([x.replace(" ", "") for x in again.stdout.splitlines()],
                         [x.replace(" ", "") for x in lines.splitlines()[:3]], again.stderr)
        made = rubric("generate", "--spec", file, "--message", "unproved", "--count", "200",
                      "--format", "hex", "--expect", str(self.folder / "expect")).stdout
        done = rubric("decode", "--spec", file, "--as", "unproved", "--format", "jsonl", stdin=made)
        wanted = [json.loads(x)["verdict"] for x in
                  (self.folder / "expect").read_text().splitlines()]
        found = ["malformed" if json.loads(x)["error"] else "valid"
                 for x in done.stdout.splitlines()]
        self.assertEqual(found, wanted)
        noted = rubric("install-wireshark", "--dir", str(self.folder), "--spec", file)
        self.assertIn("5:29: note: the size 'length - 2' can be negative", noted.stderr)

    def test_a_size_may_be_behind_what_varies(self):
        file = self.file(FLOATING, "floating.ksy")
        line = "4142000200010002" "0300AABBCC2107080909"
        args = ("--spec", file, "--as", "floating")
        shown = rubric("decode", *args, "--format", "jsonl", stdin=f"{line}\n414200050001\n")
        whole, cut = (json.loads(one) for one in shown.stdout.splitlines())
        self.assertEqual(whole["fields"], {
            "name": "AB", "n": 2, "values": [1, 2], "len_body": 3, "body": "aabbcc", "high": 2,
            "kind": 1, "chosen": {"a": 7, "b": 8}, "tail": "0909"}, shown.stderr)
        self.assertEqual((cut["error"]["fault"], cut["error"]["offset"]), ("truncated", 6))
        del whole["raw"], whole["fields"]["n"], whole["fields"]["len_body"]
        made = rubric("encode", "--spec", file, "--format", "hex", stdin=json.dumps(whole))
        self.assertEqual(made.stdout.replace(" ", ""), line + "\n", made.stderr)
        layout = rubric("explain", "--spec", file, "floating").stdout
        for text in ("2 * n", " len_body ", "tail"):
            self.assertIn(text, layout)
        expect = self.folder / "expect"
        made = rubric("generate", "--spec", file, "--message", "floating", "--count", "400",
                      "--valid", "0.5", "--format", "hex", "--expect", str(expect)).stdout
        done = rubric("decode", *args, "--format", "jsonl", stdin=made)
        wanted = [json.loads(one)["error"] for one in expect.read_text().splitlines()]
        for error, found in zip(wanted, map(json.loads, done.stdout.splitlines()), strict=True):
            found = found["error"]
            self.assertEqual(error and (error["fault"], error["offset"]),
                             found and (found["fault"], found["offset"]))

    def test_conditions_by_bits_are_explained_by_their_names(self):
        for order in ("be", "le"):
            file = self.file(f"meta: {{id: flags, endian: be, bit-endian: {order}}}\n"
                             "types:\n  one:\n    -am-type: 1\n    seq:\n"
                             "      - {id: high, type: b3}\n      - {id: there, type: b1}\n"
                             "      - {id: wide, type: b12, enum: names}\n"
                             "      - {id: a, type: u1, if: there}\n"
                             "      - {id: b, type: u1, if: 'wide == names::two'}\n"
                             "      - {id: c, size: high + wide.to_i}\n"
                             "enums: {names: {2: two}}\n", "flags.ksy")
            layout = rubric("explain", "--spec", file, "one").stdout
            for text in ("Only if there\n", "Only if wide == two\n", "  high + wide  "):
                self.assertIn(text, layout)

    def test_imports_beside_the_file_win_over_shipped_ones(self):
        shipped = pathlib.Path("spec/wire/run_time/blink_to_radio.ksy").read_text(encoding="utf-8")
        file = self.file(shipped, "blink_to_radio.ksy")
        self.assertIn("nodeid=2 counter=1", rubric("decode", "--spec", file, stdin=BLINK).stdout)
        self.file("meta: {id: tinyos}\n", "tinyos.ksy")
        self.assertIn(f"{file}:15:11: error: unknown type 'tinyos::am_header'; there is none here",
                      rubric("decode", "--spec", file, stdin=BLINK).stderr)

    def test_files_may_import_one_another(self):
        for one, other in (("ay", "bee"), ("bee", "ay")):
            file = self.file(f"meta: {{id: {one}, endian: be, imports: [{other}]}}\ntypes:\n"
                             f"  {one}_part: {{seq: [{{id: a, type: u1}}]}}\n  whole: {{seq: "
                             f"[{{id: b, type: '{other}::{other}_part'}}]}}\n", f"{one}.ksy")
        self.assertIn("=3", rubric("decode", "--spec", file, "--as", "whole", stdin="03").stdout)

    def test_mistakes_are_shown_as_by_the_compiler(self):
        file = self.file(PLAIN.replace("u2", "u9"))
        done = rubric("decode", "--spec", file, stdin="")
        self.assertEqual(done.returncode, 66)
        self.assertEqual(done.stderr,
                         f"{file}:10:15: error: unknown type 'u9'; did you mean 'u1'?\n"
                         "            type: u9\n                  ^\n")
        gone = rubric("decode", "--spec", "gone.ksy", stdin="")
        self.assertEqual((gone.returncode, gone.stderr),
                         (66, "rubric: gone.ksy: No such file or directory\n"))
        radio = self.file("meta: {id: bad}\ntypes:\n  frame:\n    -carrier: radio_t\n"
                          "    seq: [{id: a, type: u1}]\n")
        done = rubric("decode", "--spec", radio, stdin="")
        self.assertIn("carrier radio_t does not end in a message", done.stderr)

    def test_what_takes_no_byte_does_not_repeat(self):
        """Its elements would never end."""
        for repeat in ("eos", "expr, repeat-expr: n"):
            for part in ("[]", "[{id: b, size: 0}]"):
                file = self.file("meta: {id: e, endian: be}\nseq:\n  - {id: n, type: u4}\n"
                                 f"  - {{id: x, type: nul, repeat: {repeat}}}\n"
                                 f"types: {{nul: {{seq: {part}}}}}\n")
                for command in (("decode", "--as", "e"), ("generate", "--count", "2")):
                    done = rubric(command[0], "--spec", file, *command[1:], stdin="ffffffff\n")
                    self.assertEqual(done.returncode, 66)
                    self.assertIn("'x' repeats what takes no byte", done.stderr)

    def test_files_that_never_end_are_refused_at_once(self):
        endless, pipe, large, folder = (self.folder / f"{name}.ksy"
                                        for name in ("endless", "pipe", "large", "folder"))
        endless.symlink_to("/dev/zero")
        os.mkfifo(pipe)
        with large.open("wb") as file:
            file.truncate(3 << 30)
        folder.mkdir()
        other = "not a regular file"
        for path, says in ((endless, other), (pipe, other), (folder, other),
                           (large, "the file is too large; at most 1 MiB is read")):
            for command in (("decode",), ("messages",)):
                done = run(*command, "--spec", path, input="", text=True, preexec_fn=little_memory)
                self.assertEqual((done.returncode, done.stdout), (66, ""))
                self.assertEqual(done.stderr, f"{path}: error: {says}\n")
        importing = self.file(PLAIN.replace("  id: plain", "  id: plain\n  imports: [pipe]"))
        done = rubric("decode", "--spec", importing, stdin="")
        self.assertIn(f"{pipe}: error: {other}", done.stderr)

    def test_messages_without_frames_get_those_of_tinyos(self):
        message = PLAIN.replace("    seq:", "    -am-type: [0x2a, 0x2b]\n    seq:", 1)
        file = self.file(message)
        for line, framing in (("00 FFFF 0003 03 22 2A 01 0002", "hex"),
                              ("61 88 07 22 00 01 00 03 00 3F 2B 01 00 02", "hex-radio"),
                              ("61 88 07 22 00 01 00 03 00 2A 01 00 02", "hex-radio")):
            done = rubric("decode", "--spec", file, "--input-format", framing, "--format", "jsonl",
                          stdin=line)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            frame = json.loads(done.stdout)
            self.assertEqual((frame["message"], frame["am"]["src"]), ("pair", 3))
            self.assertEqual(frame["fields"], {"a": 1, "b": 2})
        inner = self.file(message + "    types: {inner: {seq: [{id: c, type: u1}]}, empty: {}}\n"
                                    "    enums: {colors: {1: red}}\n"
                                    "    instances: {twice: {value: a * 2}}\n", "inner.ksy")
        done = rubric("decode", "--spec", inner, "--format", "jsonl",
                      stdin="00 FFFF 0003 03 22 2A 01 0002")
        self.assertEqual(json.loads(done.stdout)["message"], "pair", done.stderr)
        done = rubric("encode", "--spec", file, "--as", "pair", "--format", "hex",
                      stdin='{"a":1,"b":2}')
        self.assertEqual(done.stdout, "00 FF FF 00 00 03 00 2A 01 00 02\n")
        done = rubric("install-wireshark", "--dir", str(self.folder), "--spec", file)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        twice = self.file(message + """  other:
    -am-type: 42
    seq: [{id: c, type: u1}]
""")
        done = rubric("decode", "--spec", twice, stdin="")
        self.assertEqual(done.returncode, 66)
        self.assertRegex(done.stderr, r"plain\.ksy:\d+:\d+: error: .*42")

    def test_a_file_that_no_frame_leads_to_is_told_once(self):
        for command in ("decode", "stats"):
            done = rubric(command, "--spec", self.file(PLAIN), stdin=f"{BLINK}\n{BLINK}\n")
            self.assertEqual(done.returncode, 0)
            self.assertEqual(done.stderr, "rubric: plain has no type with '-am-type' or "
                                          "'-carrier', so no frame leads to its types; --as TYPE "
                                          "reads bare ones\n")
        self.assertNotIn("0xfff", rubric("decode", "--spec", self.file(PLAIN), stdin=BLINK).stdout)

    def test_wireshark_gets_the_file_as_well(self):
        file = self.file(pathlib.Path("spec/wire/run_time/blink_to_radio.ksy").read_text(
            encoding="utf-8").replace("id: blink_to_radio\n", "id: my_blink\n"), "my_blink.ksy")
        done = rubric("install-wireshark", "--dir", str(self.folder), "--spec", file)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        dissector = (self.folder / "plugins/rubric.lua").read_text(encoding="utf-8")
        for name in ("rubicon", "oscilloscope", "blink_to_radio", "ctp", "my_blink"):
            self.assertIn(f'name = "{name}"', dissector)
        names = re.findall(r'^  \{name = "(\w+)", carriers', dissector, re.M)
        usual = int(re.search(r"usual_protocol = (\d+)", dissector)[1])
        self.assertEqual(names[usual - 1], "my_blink")
        self.refused(("install-wireshark", "--dir", str(self.folder), "--spec", self.file(PLAIN)),
                     "no packet leads to its messages", 66)


if __name__ == "__main__":
    unittest.main()
