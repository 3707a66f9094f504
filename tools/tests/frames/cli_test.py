#!/usr/bin/env python3
"""`rubric decode` as its users meet it: options, exit codes, pipes, damaged files.

Usage: cli_test.py RUBRIC.
"""

import csv
import datetime
import io
import json
import os
import pty
import re
import struct
import subprocess
import tempfile
import unittest

from testing import FIRMWARE, RUBRIC, ProgramTest, on_terminal, rubric, run

JOIN = FIRMWARE / "a_join_data.pcapng"
SERIAL = FIRMWARE / "a_join_data.serial.bin"
BAD = FIRMWARE / "h10_hdlc_escape_and_bad_serial.serial_in.bin"
PLAIN = FIRMWARE / "b_reliable.serial.bin"
CLEAN, MALFORMED, USAGE, INPUT = 0, 1, 64, 66
OUTPUT = 74


def decode(*words, stdin=b"", **more):
    return run("decode", *words, input=stdin, **more)


def lines(done):
    return done.stdout.decode("utf-8").splitlines()


class ExitCodes(ProgramTest):
    def test_clean_is_0(self):
        self.assertEqual(decode(JOIN).returncode, CLEAN)
        self.assertEqual(decode(stdin=b"").returncode, CLEAN)

    def test_malformed_is_1(self):
        self.assertEqual(decode(BAD).returncode, MALFORMED)
        self.assertEqual(decode(JOIN, BAD).returncode, MALFORMED)

    def test_hex_of_radio_frames_reads_back(self):
        radio = run("convert", JOIN, "-", "--format", "hex", "--only", "radio").stdout
        self.assertEqual(decode(stdin=radio).returncode, MALFORMED)
        again = decode("--input-format", "hex-radio", "--time", "none", stdin=radio)
        self.assertEqual(again.returncode, CLEAN)
        self.assertIn("join_request", lines(again)[0])

    def test_strict_counts_notes(self):
        self.assertEqual(decode(PLAIN).returncode, CLEAN)
        self.assertEqual(decode(PLAIN, "--strict").returncode, CLEAN)
        noted = FIRMWARE / "b_reliable.pcapng"
        self.assertEqual(decode(noted).returncode, CLEAN)
        self.assertEqual(decode(noted, "--strict").returncode, MALFORMED)

    def test_usage_is_2_and_says_what_was_meant(self):
        cases = {
            ("decoed",): "did you mean 'decode'?",
            ("decode", "--filtr", "x"): "did you mean '--filter'?",
            ("convert", "x", "--output", "y"): "did you mean '--out'?",
            ("decode", "-filter", "x"): "did you mean '--filter'?",
            ("check", "--spec", "x"): "unknown option --spec\n",
            ("decode", "--format", "xml"):
                "--format: expected one of text, jsonl, csv; given 'xml'\n",
            ("decode", "--input-format", "pcpa"): "given 'pcpa' (did you mean 'pcap'?)",
            ("decode", "--link-type", "149=raido", JOIN): "(serial, sf, radio, radio-fcs, ",
            ("simulate", "--loss", "5"): "--loss: expected a number from 0 to 1, given '5'",
            ("simulate", "--motes", "1.5"):
                "--motes: expected a whole number from 0 to 200, given '1.5'",
            ("run", "mote", "--id", "x"): "--id: expected a number, given 'x'\n",
            ("check", "--frames", "3:1..5", JOIN): "'3:1..5': the run has 1 file\n",
            ("test", "--target", "machine", "--cases", "zz*"): "rubric test: no case is called",
            ("decode", "--count", "-1"):
                "--count: expected a whole number of 1 or more, given '-1'",
            ("decode", "--count", "0"): "--count: expected a whole number of 1 or more, given '0'",
            ("decode", ""): "FILE: is empty",
            ("decode", "--filter", "message==updats"): "did you mean 'updates'?",
            ("decode", "--filter"): "rubric decode: --filter needs a value\n",
            ("decode", "--filter", "(index"): "expected ')'",
            ("decode", "--fields", "src.devd"): "unknown name",
            ("decode", "--spec", "rubicn"): "did you mean 'rubicon'?",
            ("decode", "--as", "join_requst"): "did you mean 'join_request'?",
            ("decode", "--as", "config", "--input-format", "pcap"): "--as",
            ("decode", "--input-format", "bare"): "--as",
            (): "a command is needed",
        }
        for words, wanted in cases.items():
            with self.subTest(words):
                self.refused(words, wanted)

    def test_filter_mistakes_have_a_caret(self):
        done = decode("--filter", "index>0 && src.devd==4")
        self.assertIn("  index>0 && src.devd==4\n             ^\n", done.stderr.decode())

    def test_unreadable_is_3_and_the_rest_is_read(self):
        done = decode("/nonexistent/file", JOIN)
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("/nonexistent/file: No such file", done.stderr.decode())
        self.assertEqual(lines(done), lines(decode(JOIN)))
        self.assertEqual(decode("spec").returncode, INPUT)  # A folder.
        self.assertEqual(decode(stdin=b"\x01\x02\x03 no capture").returncode, INPUT)
        sf_jsonl = decode(FIRMWARE / "a_join_data.sf.jsonl")
        self.assertEqual(sf_jsonl.returncode, INPUT)
        self.assertIn("encode", sf_jsonl.stderr.decode())

    def test_unwritable_is_74(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([RUBRIC, "decode", str(JOIN)], stdout=full,
                                  stderr=subprocess.PIPE, check=False)
        self.assertEqual(done.returncode, OUTPUT)
        self.assertIn("cannot write", done.stderr.decode())

    def test_help_that_cannot_be_written_is_74_with_a_word(self):
        # Long help is written before the end, short one at it.
        for words in (("--version",), ("--help",), ("decode", "--help")):
            with open("/dev/full", "wb") as full:
                done = subprocess.run([RUBRIC, *words], stdout=full, stderr=subprocess.PIPE,
                                      check=False)
            self.assertEqual(done.returncode, OUTPUT, words)
            self.assertIn(b"rubric: cannot write stdout", done.stderr, words)
        done = subprocess.run(f"{RUBRIC} decode --help | head -c 1", shell=True, check=False,
                              capture_output=True)
        self.assertEqual(done.stderr, b"")  # A reader that has enough is no fault.

    def test_tables_in_help_are_broken(self):
        self.assertLessEqual(max(map(len, lines(run("explore", "--help")))), 100)

    def test_a_capture_of_no_packets_says_so(self):
        header = bytes.fromhex("d4c3b2a1 0200 0400 00000000 00000000 ffff0000 c3000000")
        with tempfile.NamedTemporaryFile(suffix=".pcap") as file:
            file.write(header)
            file.flush()
            done = run("decode", file.name)
            self.assertEqual((done.returncode, done.stderr.decode()),
                             (CLEAN, f"rubric: {file.name}: holds no packets\n"))

    def test_the_same_mistake_gives_the_same_message(self):
        there = "spec/captures/firmware/a_join_data.pcapng"
        for words in (("decode", "@"), ("stats", "@"), ("encode", "@"),
                      ("convert", "@", "-o", os.devnull, "--format", "hex"),
                      ("check", "@"), ("check", there, "--expect", "@"),
                      ("test", "--target", "machine", "@"), ("chart", "@"),
                      ("test", "--target", "machine", "--expect", "@"),
                      ("shrink", "@", "--target", "machine"), ("repro", "machine", "@")):
            done = run(*(word.replace("@", "absent.rtr") for word in words))
            self.assertEqual((done.returncode, done.stderr),
                             (INPUT, b"rubric: absent.rtr: No such file or directory\n"), words)
        for words in (("decode", there, "--write", "@", "--count", "1"),
                      ("convert", there, "-o", "@", "--format", "pcapng"),
                      ("check", there, "--out", "@"),
                      ("simulate", "--seconds", "1", "--out-rtr", "@")):
            done = run(*(word.replace("@", "/dev/full") for word in words))
            self.assertEqual((done.returncode, done.stderr.splitlines()[-1]),
                             (OUTPUT, b"rubric: cannot write /dev/full: No space left on device"),
                             words)

    def test_help_is_0(self):
        done = run("--help")
        self.assertEqual(done.returncode, CLEAN)
        for command in re.findall(r"(?m)^  ([a-z-]+)   ", done.stdout.decode()):
            # Each has a footer of its own.
            help_text = run(command, "--help").stdout.decode()
            self.assertNotIn("'rubric COMMAND --help'", help_text, command)
            # A file to write has the same name everywhere, and no option takes an empty text.
            self.assertNotRegex(help_text, "(?m)^  (--out |.*--output)", command)
            for option in re.findall(r"(?m)^  (?:-\w,)?(--[\w-]+) \S", help_text):
                self.refused((command, option, ""), f"{option}: is empty")
        self.assertIn("--filter", run("decode", "--help").stdout.decode())
        for words in (("--help",), ("decode", "--help"), ("check", "--help")):
            for line in run(*words).stdout.decode().splitlines():
                self.assertTrue(len(line) <= 100 or line.startswith("  rubric "), line)
        self.assertIn("unknown option --foo", run("--foo").stderr.decode())
        self.assertRegex(run("--version").stdout.decode(), r"^\d+\.\d+")


class Damage(unittest.TestCase):
    def test_a_cut_file_prints_what_comes_before_the_cut(self):
        whole = JOIN.read_bytes()
        all_lines = lines(decode(JOIN, "--format", "jsonl"))
        done = decode("--format", "jsonl", stdin=whole[:5000])
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("stdin: damaged at byte", done.stderr.decode())
        shown = lines(done)
        self.assertGreater(len(shown), 10)
        self.assertEqual(shown[:-1], all_lines[:len(shown) - 1])
        self.assertEqual(json.loads(shown[-1])["error"]["fault"], "cut")

    def test_what_follows_a_damaged_block_is_found(self):
        whole = bytearray(JOIN.read_bytes())
        all_lines = [json.loads(line) for line in lines(decode(JOIN, "--format", "jsonl"))]
        place = all_lines[20]["offset"] - 24  # The length of the block that holds it.
        whole[place:place + 4] = b"\xff\xff\xff\x7f"
        done = decode("--format", "jsonl", stdin=bytes(whole))
        self.assertEqual(done.returncode, INPUT)
        shown = [json.loads(line) for line in lines(done)]
        self.assertEqual(len(shown), len(all_lines))
        self.assertEqual(shown[20]["error"]["fault"], "container")
        self.assertEqual([line["raw"] for line in shown[21:]],
                         [line["raw"] for line in all_lines[21:]])

    def test_a_stream_cut_in_a_frame_is_malformed(self):
        done = decode("--format", "jsonl", stdin=SERIAL.read_bytes()[:-10])
        self.assertEqual(done.returncode, MALFORMED)
        self.assertEqual(json.loads(lines(done)[-1])["error"]["fault"], "cut")


class Output(unittest.TestCase):
    def test_stdin_is_a_file(self):
        for path in (JOIN, SERIAL, BAD):
            from_file = decode(path, "--format", "jsonl")
            from_pipe = decode("-", "--format", "jsonl", stdin=path.read_bytes())
            self.assertEqual(from_file.stdout, from_pipe.stdout)
            self.assertEqual(from_file.returncode, from_pipe.returncode)

    def test_files_come_in_order_and_indexes_count_on(self):
        both = [json.loads(line) for line in lines(decode(SERIAL, JOIN, "--format", "jsonl"))]
        first = lines(decode(SERIAL, "--format", "jsonl"))
        self.assertEqual([line["index"] for line in both], list(range(len(both))))
        self.assertEqual(both[len(first)]["framing"], "radio")

    def test_numbers_count_in_each_file_from_1(self):
        of_serial, of_join = len(lines(decode(SERIAL))), len(lines(decode(JOIN)))
        numbers = [int(line[1:].split()[0]) for line in lines(decode(SERIAL, JOIN))]
        self.assertEqual(numbers, [*range(1, of_serial + 1), *range(1, of_join + 1)])
        # Before any filter, so that a frame keeps its number.
        (line,) = lines(decode(JOIN, "--filter", "number==3"))
        self.assertEqual(line, lines(decode(JOIN))[2])
        (line,) = lines(decode(JOIN, "--filter", "number==3", "--fields", "number,index"))
        self.assertEqual(line.split()[::2], ["3", "index=2"])  # The time between.

    def test_hex_text_of_either_case(self):
        sent = "00 FF FF 00 00 03 00 25 0A 00 0C\n"
        for text in (sent, sent.lower(), sent.replace(" ", "")):
            line = json.loads(decode("--format", "jsonl", stdin=text.encode()).stdout)
            self.assertEqual(line["message"], "config")
            self.assertEqual(line["fields"],
                             {"type": 10, "type_name": "set_island_id", "value": 12})

    def test_bare_messages(self):
        two = decode("--as", "config", "--format", "jsonl", stdin=b"0a000c\n01 00 02\n")
        self.assertEqual([json.loads(line)["fields"]["value"] for line in lines(two)], [12, 2])
        with tempfile.NamedTemporaryFile() as file:
            file.write(b"\x0a\x00\x0c")
            file.flush()
            one = decode("--as", "config", "--format", "jsonl", file.name)
        line = json.loads(one.stdout)
        self.assertEqual((line["framing"], line["fields"]["value"], line["raw"]),
                         ("bare", 12, "0a000c"))

    def test_a_capture_file_is_not_a_bare_message(self):
        done = decode("--as", "config", JOIN)
        self.assertEqual((done.returncode, done.stdout), (INPUT, b""))
        self.assertIn("this is pcapng; --as takes a message alone", done.stderr.decode())
        done = decode("--as", "config", "--input-format", "bare", JOIN)
        self.assertEqual((done.returncode, len(lines(done))), (CLEAN, 1))

    def test_count_stops(self):
        self.assertEqual(len(lines(decode(JOIN, "--count", 3))), 3)
        only = decode(JOIN, "--count", 2, "--filter", "message==updates", "--format", "jsonl")
        self.assertEqual([json.loads(line)["message"] for line in lines(only)], ["updates"] * 2)

    def test_filter_selects(self):
        some = decode(JOIN, "--filter", "message==updates && src.devid==4", "--format", "jsonl")
        every = [json.loads(line) for line in lines(decode(JOIN, "--format", "jsonl"))]
        wanted = [line for line in every if line["message"] == "updates"
                  and line["fields"]["src"]["devid"] == 4]
        self.assertGreater(len(wanted), 5)
        self.assertEqual([json.loads(line) for line in lines(some)], wanted)

    def test_times(self):
        def times(*words):
            done = decode(JOIN, "--count", 3, "--format", "jsonl", *words)
            return [json.loads(line)["time"] for line in lines(done)]
        absolute = times()
        self.assertEqual(times("--time", "none"), [None] * 3)
        days = [datetime.datetime.fromisoformat(t.rstrip("Z") + "+00:00").timestamp()
                for t in times("--time", "utc")]
        self.assertEqual([round(d, 6) for d in days], [round(t, 6) for t in absolute])
        self.assertEqual(times("--time", "relative"),
                         [round(t - absolute[0], 9) for t in absolute])
        self.assertEqual(times("--time", "delta"),
                         [0] + [round(b - a, 9) for a, b in zip(absolute, absolute[1:])])

    def test_csv(self):
        table = list(csv.DictReader(io.StringIO(decode(JOIN, "--format", "csv").stdout.decode())))
        every = [json.loads(line) for line in lines(decode(JOIN, "--format", "jsonl"))]
        self.assertEqual(len(table), len(every))
        for row, line in zip(table, every):
            self.assertEqual(row["message"], line["message"])
            self.assertEqual(float(row["time"]), line["time"])
            self.assertEqual(row["am.type"], str(line["am"]["type"]) if line["am"] else "")

    def test_other_protocols(self):
        message = "00 ffff 0001 1c 22 93 0001 00fa 0007 0014" + " 0123" * 10
        done = decode("--spec", "oscilloscope", "--format", "jsonl", stdin=message.encode())
        line = json.loads(done.stdout)
        self.assertEqual(line["message"], "oscilloscope_msg")
        self.assertEqual(line["fields"]["readings"], [0x123] * 10)

    def test_units_and_hex(self):
        text = decode(JOIN, "--count", 1, "--hex").stdout.decode()
        self.assertIn("        0000  41 88", text)
        reply = decode("--as", "data", "--units", stdin=b"0001 18c4 04b2 012e 0003")
        self.assertIn("temp=23.4degC", reply.stdout.decode())


class Terminals(unittest.TestCase):
    def test_colour_only_where_it_is_wanted(self):
        self.assertNotIn(b"\033", decode(JOIN).stdout)
        self.assertIn(b"\033", decode(JOIN, "--color", "always").stdout)
        self.assertIn(b"\033", self.on_terminal({"TERM": "xterm"}))
        self.assertNotIn(b"\033", self.on_terminal({"TERM": "xterm", "NO_COLOR": "1"}))
        self.assertNotIn(b"\033", self.on_terminal({"TERM": "dumb"}))
        self.assertNotIn(b"\033", self.on_terminal({"TERM": "xterm"}, "--color", "never"))

    def test_lines_fit_the_terminal(self):
        for width in (60, 100):
            shown = self.on_terminal({"TERM": "dumb"}, width=width).decode().splitlines()
            self.assertGreater(len(shown), 1)
            self.assertLessEqual(max(map(len, shown)), width)
            self.assertEqual(" ".join(" ".join(shown).split()),
                             " ".join(lines(decode(JOIN, "--count", "1"))[0].split()))
        wide = self.on_terminal({"TERM": "dumb"}, "--width", "0", width=60)
        self.assertEqual(wide.count(b"\n"), 1)
        self.assertEqual(len(lines(decode(JOIN, "--count", "1", "--width", "60"))), 3)

    def test_who_reads_a_terminal_says_so(self):
        for words in (["decode"], ["stats"], ["encode"], ["convert", "--format", "hex"],
                      ["check", "-"], ["check", JOIN, "--expect", "-"]):
            leader, follower = pty.openpty()
            with subprocess.Popen([RUBRIC, *words], stdin=follower, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE) as process:
                self.assertIn(b"reads what is typed here", process.stderr.readline(), words)
                process.kill()
            os.close(follower)
            os.close(leader)

    def on_terminal(self, env, *words, width=0):
        code, shown = on_terminal("decode", JOIN, "--count", "1", *words, env=env, width=width)
        self.assertEqual(code, 0)
        return shown

    def test_a_closed_pipe_ends_it_quietly(self):
        # More than any pipe takes, so that writing fails.
        stream = SERIAL.read_bytes() * 400
        with tempfile.TemporaryFile() as file:
            file.write(stream)
            file.seek(0)
            with subprocess.Popen([RUBRIC, "decode", "--format", "jsonl"], stdin=file,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
                json.loads(process.stdout.readline())
                process.stdout.close()
                self.assertEqual(process.stderr.read(), b"")
                self.assertEqual(process.wait(), OUTPUT)

    def test_what_comes_slowly_is_shown_at_once(self):
        with subprocess.Popen([RUBRIC, "decode", "--input-format", "hdlc"], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE) as process:
            process.stdin.write(SERIAL.read_bytes()[:300])
            process.stdin.flush()
            self.assertIn(b"serial_joined", process.stdout.readline())
            process.stdin.close()


class WideNumbers(unittest.TestCase):
    ARGS = ("--spec", "spec/kaitai_check/wide.ksy", "--as", "wide")
    FIELDS = {"big": 2**64 - 1, "little": 2**63, "below": -2**63, "kind": 2**53 + 1,
              "kind_name": None, "count": 0, "counted": [], "tail": [2**64 - 2, 7]}
    RAW = (struct.pack(">Q", 2**64 - 1) + struct.pack("<Q", 2**63) +
           struct.pack(">qQB2Q", -2**63, 2**53 + 1, 0, 2**64 - 2, 7)).hex()

    def test_they_are_whole_wherever_they_are_shown(self):
        def shown(command, *more, stdin=self.RAW):
            return rubric(command, *self.ARGS, *more, stdin=stdin)[1]
        self.assertEqual(json.loads(shown("decode", "--format", "jsonl"))["fields"], self.FIELDS)
        text = "big=18446744073709551615 little=9223372036854775808 below=-9223372036854775808"
        self.assertIn(f"{text} kind=9007199254740993 ", shown("decode", "--width", "300"))
        self.assertIn(" 18446744073709551615\n", shown("explain", self.RAW))
        chosen = json.loads(shown("decode", "--format", "jsonl", "--fields", "big,below,tail"))
        self.assertEqual({name: chosen[name] for name in ("big", "below", "tail")},
                         {name: self.FIELDS[name] for name in ("big", "below", "tail")})
        self.assertEqual(shown("decode", "--format", "csv", "--fields", "big,tail").split()[1:],
                         ["18446744073709551615,18446744073709551614", "7"])
        wrong = self.RAW[:64] + "cc" + 16 * "f"  # `few` is there where `count` is above 200.
        self.assertIn("few is 18446744073709551615, allowed are 0 to 1000",
                      shown("decode", stdin=wrong))

    def test_units_convert_all_digits(self):
        spec = """meta: {id: scaled, endian: be}
seq:
  - {id: tenth, type: u8, -unit: {symbol: A, scale: 0.1}}
  - {id: below, type: s8, -unit: {symbol: degC, scale: 0.01, offset: -40}}
  - {id: small, type: u4, -unit: {symbol: m, scale: 0.001}}
  - {id: many, type: u8, repeat: eos, -unit: {symbol: s, scale: 1e-9, offset: 0.5}}
"""
        shown = {"tenth_A": "1844674407370955161.5", "below_degC": "-92233720368547798.08",
                 "small_m": "4294967.295", "many_s": "9223372036.354775806 0.5"}
        raw = struct.pack(">QqIQQ", 2**64 - 1, -2**63, 2**32 - 1, 9223372035854775806, 0).hex()
        with tempfile.NamedTemporaryFile("w", suffix=".ksy") as file:
            file.write(spec)
            file.flush()

            def decode(*more):
                return rubric("decode", "--spec", file.name, "--as", "scaled", *more, stdin=raw)[1]
            text = decode("--units", "--width", "300")
            fields = json.loads(decode("--units", "--format", "jsonl"), parse_float=str)["fields"]
            names = ",".join(shown)
            alone = json.loads(decode("--format", "jsonl", "--fields", names), parse_float=str)
            self.assertEqual(decode("--format", "csv", "--fields", names).splitlines()[1],
                             ",".join(shown.values()))
            explained = rubric("explain", "--spec", file.name, "--as", "scaled", raw)[1]
            for name, value in shown.items():
                field, unit = name.split("_")
                inner = "".join(f"{one}{unit} " for one in value.split())[:-1]
                self.assertIn(f"{field}=[{inner}]" if " " in value else f"{field}={inner}", text)
                wanted = value.split() if " " in value else value
                self.assertEqual((fields[name], alone[name]), (wanted, wanted))
                self.assertIn("" if " " in value else f" {value} {unit}\n", explained)

    def test_filters_compare_them_exactly(self):
        for holds, words in ((True, (
            "big==18446744073709551615", "big==0xffffffffffffffff", "big>9223372036854775807",
            "big>little", "big>kind", "below<big", "below<0", "big>-1", "little!=below",
            "little==9223372036854775808", "tail==18446744073709551614",
            "big & 0x8000000000000000", "big>1e19", "kind>9007199254740992.5",
            "kind<9007199254740993.5", "kind==9007199254740993.0", "kind==90071992547409930e-1",
            "below==-9.223372036854775808e18", "below>-9223372036854775808.1",
            "big==1.8446744073709551615e+19", "big<1e300", "count==0e99999", "count<1e-300",
            "count>-0.5", "9007199254740992.5<kind", "little!=9223372036854775808.5")), (False, (
                "kind==9007199254740992.5", "kind<9007199254740992.5",
                "big>=18446744073709551615.5",
                "below<-9223372036854775808.1", "below==-9223372036854775807.5", "count>1e-300",
                "count==-0.1", "big==1.8446744073709551616e19",
                "big==-1", "big<0", "big<=below", "kind==9007199254740992", "little==below",
                "kind==9007199254740994", "little>9223372036854775808",
                "count>9223372036854775808"))):
            for word in words:
                out = rubric("decode", *self.ARGS, "--filter", word, stdin=self.RAW)[1]
                self.assertEqual(bool(out), holds, word)

    def test_what_does_not_fit_is_not_written(self):
        line = json.dumps(self.FIELDS)
        _, out, err = rubric("encode", *self.ARGS, "--carrier", "none", "--format", "hex",
                             stdin=line)
        self.assertEqual(out.replace(" ", "").strip().lower(), self.RAW, err)
        for value in ("-1", str(2**64), "1.5", "-0"):
            _, out, err = rubric("encode", *self.ARGS, "--carrier", "none",
                                 stdin=line.replace(str(2**64 - 1), value, 1))
            self.assertIn(f"big: expected a number from 0 to {2**64 - 1}, given {value}", err)


if __name__ == "__main__":
    unittest.main()
