#!/usr/bin/env python3
"""rubric generate: what its expectations say is what `rubric decode` says of its files.

Usage: generate_test.py RUBRIC
"""

import json
import struct
import unittest

from testing import Folder, run as run_any

COUNT = 10000
ENHANCED_PACKET = 6
COMMENT = 1
# Frames that begin otherwise than with TinyOS's headers.
OWN_HEADERS = """
meta: {id: own, endian: be}
-carrier: serial
seq:
  - {id: head, type: u1}
  - {id: kind, type: u1}
  - {id: body, size-eos: true, type: {switch-on: kind, cases: &bodies {1: one}}}
types:
  on_air:
    -carrier: radio_t
    seq:
      - {id: fcf, type: u2le}
      - {id: dsn, type: u1}
      - {id: pan, type: u2le}
      - {id: to, type: u2le}
      - {id: from, type: u2le}
      - {id: kind, type: u1}
      - {id: body, size-eos: true, type: {switch-on: kind, cases: *bodies}}
  one: {seq: [{id: a, type: u2}, {id: rest, size-eos: true}]}
"""
RADIO_MESSAGES = ["ack_join", "join_reply", "join_request", "mac_ack", "rssi_beacon"]


def run(*arguments, code=0, **more):
    done = run_any(*arguments, **more)
    assert done.returncode == code, (arguments, done.returncode, done.stderr.decode())
    return done


def lines(data):
    return [json.loads(line) for line in data.splitlines()]


def decoded(*arguments, **more):
    """The records of a capture in which something is malformed."""
    return lines(run("decode", "--format", "jsonl", *arguments, code=1, **more).stdout)


def comments(data):
    """The comment of each packet of a little-endian pcapng file."""
    found = []
    at = 0
    while at < len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind == ENHANCED_PACKET:
            captured, = struct.unpack_from("<I", data, at + 20)
            option = at + 28 + (captured + 3) // 4 * 4
            code, length = struct.unpack_from("<HH", data, option)
            assert code == COMMENT
            found.append(data[option + 4:option + 4 + length].decode())
        at += size
    return found


class Generate(Folder):
    maxDiff = 3000

    def generate(self, form, *arguments):
        """The file, and its expectations."""
        target = self.folder / f"frames.{form}"
        beside = self.folder / f"frames.{form}.jsonl"
        run("generate", "--format", form, "-o", str(target), "--expect", str(beside), *arguments)
        return target, lines(beside.read_bytes())

    def assert_agrees(self, record, wanted):
        """decode agrees with the expectation of a frame."""
        place = f"frame {wanted['number']}: {wanted['what']}"
        error = record["error"]
        if error is not None:
            error = {key: error[key] for key in ("fault", "offset", "requirement")}
        self.assertEqual(error, wanted["error"], place)
        self.assertEqual(record["raw"], wanted["raw"], place)
        self.assertEqual(wanted["verdict"], "malformed" if wanted["error"] else "valid", place)
        if wanted["verdict"] == "valid":
            self.assertEqual(record["path"], wanted["path"], place)
        unfit = [note for note in record["notes"] if note["note"] == "does_not_fit"]
        if wanted["unfit"]:
            self.assertEqual(len(unfit), 1, place)
            self.assertLessEqual(unfit[0]["offset"], wanted["unfit"]["offset"], place)

    def assert_all_agree(self, records, expected):
        self.assertEqual(len(records), len(expected))
        for record, wanted in zip(records, expected):
            self.assert_agrees(record, wanted)
        verdicts = [wanted["verdict"] for wanted in expected]
        self.assertGreater(verdicts.count("malformed"), len(expected) // 6)
        self.assertGreater(verdicts.count("valid"), len(expected) // 2)

    def test_decode_agrees_with_each_expectation(self):
        for form in ("hdlc", "sf", "hex", "pcapng"):
            for seed in ("1", "2"):
                with self.subTest(f"{form} {seed}"):
                    file, expected = self.generate(form, "--count", str(COUNT), "--seed", seed)
                    records = decoded(str(file))
                    self.assert_all_agree(records, expected)
                    self.assertEqual([record["offset"] for record in records],
                                     [wanted["offset"] for wanted in expected])
                    self.assertEqual([record["framing"] for record in records],
                                     [wanted["framing"] for wanted in expected])

    def test_decode_agrees_with_each_jsonl_line(self):
        expected = lines(run("generate", "--count", str(COUNT)).stdout)
        self.assertEqual([wanted["number"] for wanted in expected], list(range(1, COUNT + 1)))
        for form, framing in (("hex", "sf"), ("hex-radio", "radio")):
            chosen = [wanted for wanted in expected if wanted["framing"] == framing]
            self.assertGreater(len(chosen), COUNT // 4)
            text = "".join(wanted["raw"] + "\n" for wanted in chosen).encode()
            self.assert_all_agree(decoded("--input-format", form, input=text), chosen)

    def test_another_protocol(self):
        for form in ("hdlc", "sf", "hex", "pcapng"):
            file, expected = self.generate(form, "--spec", "oscilloscope", "--count", "500")
            self.assert_all_agree(decoded("--spec", "oscilloscope", str(file)), expected)
            self.assertIn("oscilloscope_msg", {wanted["message"] for wanted in expected})

    def test_every_message_comes_up(self):
        known = {row["message"] for row in lines(run("generate", "--count", "500").stdout)}
        self.assertTrue(known.issuperset(RADIO_MESSAGES))
        self.assertTrue(known.issuperset(["net_msg", "app_msg", "updates", "config", "command"]))
        self.assertGreaterEqual(len(known), 26)
        exactly = lines(run("generate", "--count", str(len(known))).stdout)
        self.assertEqual({row["message"] for row in exactly}, known)

    def test_pcapng_says_in_comments_what_is_expected(self):
        file, expected = self.generate("pcapng", "--count", "300")
        found = comments(file.read_bytes())
        self.assertEqual(len(found), 300)
        for comment, wanted in zip(found, expected):
            self.assertTrue(comment.startswith(wanted["verdict"] + ": "), comment)
            self.assertTrue(comment.endswith(wanted["what"]), comment)
            if wanted["error"]:
                self.assertIn(f"({wanted['error']['requirement']})", comment)

    def test_the_same_options_give_the_same_bytes(self):
        for form in ("hdlc", "pcapng", "jsonl"):
            one = run("generate", "--format", form, "--count", "200", "--seed", "9").stdout
            self.assertEqual(one, run("generate", "--format", form, "--count", "200", "--seed",
                                      "9").stdout)
            self.assertNotEqual(one, run("generate", "--format", form, "--count", "200", "--seed",
                                         "8").stdout)

    def test_fields_are_the_numbers_of_valid_frames(self):
        rows = lines(run("generate", "--fields", "--count", "200", "--message", "config").stdout)
        text = "".join(row["raw"] + "\n" for row in rows).encode()
        for row, record in zip(rows, decoded("--input-format", "hex", input=text)):
            if row["error"]:
                self.assertIsNone(row["fields"])
                continue
            values = {field["field"]: field["value"] for field in row["fields"]}
            wanted = {"am_header.dispatch": 0}
            wanted.update({f"am_header.{key}": value for key, value in record["am"].items()})
            wanted.update({f"config.{key}": record["fields"][key] for key in ("type", "value")})
            self.assertEqual(values, wanted)
            offsets = [field["offset"] for field in row["fields"]]
            self.assertEqual(offsets, sorted(set(offsets)))
        self.assertNotIn("fields", lines(run("generate", "--count", "30").stdout)[0])

    def test_valid_is_the_share(self):
        for share in ("0", "0.25", "1"):
            rows = lines(run("generate", "--count", "4000", "--valid", share).stdout)
            sound = [row for row in rows if row["verdict"] == "valid" and not row["unfit"]]
            self.assertAlmostEqual(len(sound) / len(rows), float(share), delta=0.03)

    def test_only_the_messages_asked_for(self):
        rows = lines(run("generate", "--count", "50", "--message", "updates", "config").stdout)
        self.assertEqual({row["message"] for row in rows}, {"updates", "config"})

    def test_what_a_format_leaves_out_is_said(self):
        for form in ("hdlc", "sf", "hex"):
            said = run("generate", "--format", form, "--count", "50").stderr.decode()
            self.assertIn(f"{form} holds no radio frames: left out", said)
            for message in RADIO_MESSAGES:
                self.assertIn(message, said)
        for form in ("pcapng", "jsonl"):
            self.assertEqual(run("generate", "--format", form, "--count", "50").stderr, b"")
        said = run("generate", "--count", "3").stderr.decode()
        self.assertIn("messages do not come up", said)

    def test_headers_that_are_not_tinyos_are_fields(self):
        spec = self.write("own.ksy", OWN_HEADERS)
        hand_made = (
            # This could begin with an AM header.
            ("00 01 FF FF 00 05 00 22 06", {"head": 0, "kind": 1, "body": {"a": 0xffff, "rest":
                                                                          "0005002206"}}),
            ("07 02 03 04", {"head": 7, "kind": 2, "body": "0304"}),
            ("41 88 07 22 00 01 00 02 00 01 00 09 AA",
             {"fcf": 0x8841, "dsn": 7, "pan": 0x22, "to": 1, "from": 2, "kind": 1,
              "body": {"a": 9, "rest": "aa"}}))
        for raw, fields in hand_made:
            form = ("--input-format", "hex-radio", "--fcs", "none") if "fcf" in fields else ()
            shown = self.shows(("decode", "--spec", spec, "--format", "jsonl", *form), stdin=raw)
            record = json.loads(shown)
            self.assertEqual(record["fields"], fields)
            self.assertEqual(record["am"] is None, not form)
            for whole in (record, {k: v for k, v in record.items() if k != "raw"}):
                self.shows(("encode", "--spec", spec), raw + "\n", stdin=json.dumps(whole))
            edited = "dsn" if form else "head"
            record["fields"][edited] = 9
            self.refused(("encode", "--spec", spec), f'fields.{edited}: given 9, but "raw" says',
                         code=66, stdin=json.dumps(record))
        self.refused(("encode", "--spec", spec, "--as", "one"), "headers of their own")
        file, wanted = self.generate("pcapng", "--spec", str(spec), "--count", "300")
        shown = run("decode", "--spec", str(spec), "--format", "jsonl", str(file), code=1).stdout
        valid = [(line, one["raw"]) for line, one in zip(shown.splitlines(), wanted, strict=True)
                 if one["verdict"] == "valid"]
        self.assertGreater(len(valid), 50)
        made = run("encode", "--spec", str(spec), input=b"\n".join(line for line, _ in valid))
        self.assertEqual([raw for _, raw in valid],
                         made.stdout.decode().replace(" ", "").lower().splitlines())

    def assert_refused(self, text, *arguments, code=64):
        said = run("generate", *arguments, code=code).stderr.decode()
        self.assertIn(text, said)

    def test_what_makes_no_sense_is_refused(self):
        target = str(self.folder / "x")
        for share in ("1.2", "-0.1", "nan", "much"):
            self.assert_refused("expected a share from 0 to 1", "--valid", share)
        self.assert_refused("--valid: is empty", "--valid", "")
        self.assert_refused("--count", "--count", "0")
        self.assert_refused("--seed", "--seed", "-1")
        self.assert_refused("--format", "--format", "pcap")
        self.assert_refused("did you mean 'updates'", "--message", "updats")
        self.assert_refused("did you mean 'oscilloscope'", "--spec", "osciloscope")
        self.assert_refused("pcapng and jsonl do", "--format", "sf", "--message", "join_request")
        self.assert_refused("jsonl carries the expectations", "--expect", target)
        self.assert_refused("is also an input or another output", "--format", "hex",
                            "-o", target, "--expect", target)
        self.assert_refused("No such file", "-o", str(self.folder / "no" / "x"), code=74)
        self.assert_refused("No such file", "--format", "hex", "--expect",
                            str(self.folder / "no" / "x"), code=74)


if __name__ == "__main__":
    unittest.main()
