#!/usr/bin/env python3
"""`rubric check` as its users meet it.

Usage: check_test.py RUBRIC [--regenerate] in the project's folder; --regenerate writes the texts in
tools/tests/check/expect anew instead of comparing with them.
"""

import json
import pathlib
import re
import shlex
import sys
import unittest
import xml.etree.ElementTree

from testing import FIRMWARE, Folder, on_terminal, rubric, some

REGENERATE = "--regenerate" in sys.argv and (sys.argv.remove("--regenerate") or True)
BASESTATION = pathlib.Path("spec/captures/basestation")
EXPECT = pathlib.Path("tools/tests/check/expect")
WRONG_SEQ = FIRMWARE / "g2_stray_reply_while_joining.pcapng"
CLEAN = FIRMWARE / "f_synaptic.pcapng"

GOLDEN = {
    "wrong_seq": [WRONG_SEQ],
    "malformed_forward": [FIRMWARE / "h4_stale_bytes.pcapng"],
    "clean": [CLEAN],
    "clock_stands_still": [FIRMWARE / "a_join_data.pcapng"],
}
FINDING_KEYS = ["requirement", "level", "sentence", "severity", "time", "file", "frame", "offset",
                "node", "text", "expected", "count", "last_frame", "known", "hypotheses"]


def check(*args, **more):
    return rubric("check", *args, **more)


def as_json(*args, **more):
    code, out, err = check("--format", "json", *args, **more)
    report = json.loads(out)
    assert code == report["exit_code"], (args, code, err)
    return report


def failures(report):
    return [f for f in report["findings"] if f["severity"] == "fail"]


def capture_files():
    return some(sorted(FIRMWARE.glob("*.pcapng")) + sorted(FIRMWARE.glob("*.serial.bin")) +
                sorted(BASESTATION.glob("*.sfstream")))


class Text(Folder):
    def test_golden(self):
        for name, files in GOLDEN.items():
            path = EXPECT / f"{name}.txt"
            out = check(*files)[1]
            if REGENERATE:
                path.write_text(out)
            self.assertEqual(out, path.read_text(),
                             f"{path}; renew with check_test.py RUBRIC --regenerate")

    def test_a_frame_has_the_number_that_decode_shows(self):
        seen = 0
        for file in capture_files():
            out = rubric("decode", "--format", "csv", "--fields", "number,offset", file)[1]
            offsets = dict(line.split(",") for line in out.splitlines()[1:])
            for finding in as_json(file)["findings"]:
                if finding["frame"] is not None:
                    self.assertEqual(offsets[str(finding["frame"])], str(finding["offset"]), file)
                    seen += 1
        self.assertGreater(seen, 5)

    def test_again_shows_the_same_finding(self):
        """Runs every command below a failure, as it is printed."""
        ran = 0
        for file in capture_files():
            for more in [[], ["--profile", "deployed"], ["--sniffer", "complete"],
                         ["--start", "cold", "--sniffer", "complete"]]:
                ran += self.run_again(check(*more, file)[1])
        self.assertGreater(ran, 5)

    def test_again_of_a_log(self):
        log = self.folder / "run.rtr"
        rubric("simulate", "--scenario", "timeline", "--out-rtr", log)
        complete = ["--sniffer", "complete", "--start", "cold"]
        rules = {f["requirement"] for f in failures(as_json(*complete, log))}
        self.assertNotIn("J4-JOINED", rules)
        # The second mote's reply was never sent, yet it acknowledges it.
        lines = log.read_text().splitlines(keepends=True)
        silent = self.write("silent reply.rtr", "".join(
            line for line in lines if "join_reply(" not in line or "mote_addr=4" not in line))
        out = self.shows(("check", *complete, silent), "FAIL J4-JOINED, mote 4, ", code=1)
        number = next(i for i, line in enumerate(silent.read_text().splitlines(), 1)
                      if "m4  >  rA" in line and "ack_join" in line)
        self.assertRegex(out, rf"  > +\d+  line {number}, ")
        self.assertGreater(self.run_again(out), 0)

    def run_again(self, out):
        """Runs the command below each failure in full; how many there were."""
        ran = 0
        for part in re.split(r"^(?=FAIL )", out, flags=re.M)[1:]:
            again = re.search(r"^  Again:    rubric (.*)$", part, re.M)
            if not again:
                continue  # A line of its own below the first of its rule.
            heading = part.replace("\n ", "")
            rule, node, frame = re.match(
                r"FAIL (\S+), (?:(.*?), )?frame (\d+)\b", heading).groups()
            code, text, err = rubric(*shlex.split(again[1]), "--format", "json")
            self.assertEqual((code, err), (1, ""), again[1])
            found = {(f["requirement"], f["node"], f["frame"]) for f in failures(json.loads(text))}
            self.assertIn((rule, node, int(frame)), found, again[1])
            ran += 1
        return ran

    def test_width(self):
        for width in (60, 100, 140):
            out = check("--width", width, FIRMWARE / "h4_stale_bytes.pcapng")[1]
            # Charts and commands are as wide as they must be.
            prose = [line for line in out.splitlines() if "|" not in line and "Again:" not in line
                     and "(" not in line and "unknown 2" not in line]
            self.assertLessEqual(max(map(len, prose)), width)
        self.assertEqual(check("--width", 10, CLEAN)[0], 64)

    def test_colours_only_on_terminals(self):
        self.assertNotIn("\033", check(WRONG_SEQ)[1])
        self.assertIn("\033[1;31mFAIL\033[0m J4-SEQ", check("--color", "always", WRONG_SEQ)[1])
        for env, coloured in [({"TERM": "xterm", "NO_COLOR": ""}, True),
                              ({"TERM": "xterm", "NO_COLOR": "1"}, False),
                              ({"TERM": "dumb", "NO_COLOR": ""}, False)]:
            code, out = on_terminal("check", WRONG_SEQ, env=env)
            self.assertEqual(code, 1)
            self.assertEqual(b"\033[" in out, coloured, env)

    def test_verbose_says_more(self):
        file = FIRMWARE / "a_join_data.pcapng"
        short, long = check(file)[1], check("--verbose", file)[1]
        # The first failure in full; with --verbose the second and the note as well.
        self.assertEqual((short.count("  Rule: "), long.count("  Rule: ")), (1, 3))


class Formats(Folder):
    def test_json(self):
        for file in capture_files():
            report = as_json(file)
            self.assertEqual(list(report), ["schema", "verdict", "expected", "exit_code",
                                            "input_missing", "profile", "sniffer", "start", "files",
                                            "findings", "counts", "facts", "exercised"])
            self.assertFalse(report["input_missing"])
            self.assertEqual(report["schema"], "rubric.check/1")
            self.assertEqual(report["files"], [str(file)])
            for finding in report["findings"]:
                self.assertEqual(list(finding), FINDING_KEYS)
                self.assertIn(finding["severity"],
                              ["fail", "weak", "stray", "inconclusive", "note"])
                self.assertTrue(finding["text"])
                self.assertGreaterEqual(finding["count"], 1)
            for severity in ["fail", "weak", "stray", "inconclusive", "note"]:
                count = sum(f["severity"] == severity for f in report["findings"])
                self.assertEqual(report["counts"][severity], count)
            self.assertEqual(report["counts"]["rules_exercised"], len(report["exercised"]))

    def test_json_places_frames(self):
        """Number and offset lead to the frame that decode shows."""
        report = as_json(WRONG_SEQ)
        [finding] = failures(report)
        self.assertEqual((finding["requirement"], finding["level"], finding["node"]),
                         ("J4-SEQ", "MUST", "mote 2"))
        lines = rubric("decode", "--format", "jsonl", WRONG_SEQ)[1].splitlines()
        frame = json.loads(lines[finding["frame"] - 1])
        self.assertEqual((frame["message"], frame["offset"]), ("ack_join", finding["offset"]))
        self.assertTrue(finding["hypotheses"][0]["miss"])

    def test_junit(self):
        for file in capture_files():
            report = as_json(file)
            code, out, err = check("--format", "junit", file)
            self.assertEqual((code, err), (report["exit_code"], ""))
            [suite] = xml.etree.ElementTree.fromstring(out)
            cases = suite.findall("testcase")
            names = [case.get("name") for case in cases]
            self.assertEqual(len(names), len(set(names)))
            self.assertEqual(int(suite.get("tests")), len(cases))
            broken = {f["requirement"] for f in failures(report)}
            self.assertEqual({c.get("name") for c in cases if c.find("failure") is not None},
                             broken)
            self.assertEqual(int(suite.get("failures")), len(broken))
            skipped = {f["requirement"] or "(no rule)" for f in report["findings"]
                       if f["severity"] == "inconclusive"} - broken
            self.assertEqual({c.get("name") for c in cases if c.find("skipped") is not None},
                             skipped)
            exercised = {e["requirement"] for e in report["exercised"]}
            self.assertLessEqual(exercised, set(names))
            for case in cases:
                for failure in case.findall("failure"):
                    self.assertTrue(failure.get("message"))
                    self.assertIn("Rule: ", failure.text)

    def test_out(self):
        path = self.folder / "report.json"
        code, out, err = check("--format", "json", "--out", path, WRONG_SEQ)
        self.assertEqual((code, out, err), (1, "", ""))
        self.assertEqual(path.read_text(), check("--format", "json", WRONG_SEQ)[1])

    def test_a_folder_of_reports(self):
        capture = self.write("<b>&.pcapng", WRONG_SEQ.read_bytes())
        folder = self.folder / "report"
        code, out, _ = check(capture, "--report", folder)
        self.assertEqual((code, out), check(capture)[:2])
        page = (folder / "index.html").read_text(encoding="utf-8")
        verdict = " ".join(out[out.rindex("Verdict:"):].split())
        self.assertIn(f"<h2>{verdict}</h2>", page)
        self.assertIn("&lt;b&gt;&amp;.pcapng", page)
        self.assertNotIn("<b>&", page)
        self.assertNotRegex(page, "<script|https?://")
        report = as_json(capture)
        for finding in report["findings"]:
            self.assertIn(f"<code>{finding['requirement'] or 'no rule'}</code>", page)
        order = re.findall(r'<b class="(\w+)">', page)
        ranks = ["fail", "inconclusive", "stray", "weak", "note"]
        self.assertEqual(order, sorted(order, key=ranks.index))
        self.assertEqual(len(order), len(report["findings"]))
        self.assertEqual(page.count("<details open>"), len(failures(report)))
        self.assertEqual(json.loads((folder / "report.json").read_bytes()), report)
        self.assertIn("<testsuite", (folder / "junit.xml").read_text(encoding="utf-8"))
        (self.folder / "file").touch()
        self.assertEqual(check(capture, "--report", self.folder / "file")[0], 74)


class Expectations(Folder):
    KNOWN = "- requirement: J4-SEQ\n  message: %s\n  reason: Release 1.0 accepts any reply.\n"

    def against(self, text, *args):
        return check("--expect", self.write("known.yaml", text), *args)

    def test_known(self):
        code, out, err = self.against(self.KNOWN % "ack_join", WRONG_SEQ)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("EXPECTED FAIL J4-SEQ", out)
        self.assertIn("Release 1.0 accepts any reply.", out.replace("\n ", ""))
        self.assertIn("Verdict: fail as expected: 0 failures, 1 known failure expected", out)
        report = as_json("--expect", self.folder / "known.yaml", WRONG_SEQ)
        self.assertEqual((report["verdict"], report["expected"]), ("fail", True))
        [finding] = failures(report)
        self.assertEqual(finding["known"], "Release 1.0 accepts any reply.")
        [expectation] = report["expectations"]
        self.assertEqual((expectation["came"], expectation["line"]), ("matched", 1))
        self.assertEqual(report["findings"][expectation["findings"][0]], finding)

    def test_not_true(self):
        for file, message, says, came in [
            (CLEAN, "ack_join", "STALE", "stale"),
            (WRONG_SEQ, "a purple frame", "OTHER MESSAGE", "other_message"),
        ]:
            code, out, _ = self.against(self.KNOWN % message, file)
            self.assertEqual(code, 1)
            self.assertIn(says, out)
            report = as_json("--expect", self.folder / "known.yaml", file)
            self.assertEqual((report["expected"], report["expectations"][0]["came"]),
                             (False, came))
            suite = check("--format", "junit", "--expect", self.folder / "known.yaml", file)[1]
            self.assertIn(f'<failure type="{came}"', suite)

    def test_about_other_files(self):
        text = self.KNOWN % "ack_join" + "  file: 'g2_*'\n"
        self.assertEqual(self.against(text, WRONG_SEQ)[0], 0)
        self.assertEqual(self.against(text, CLEAN)[0], 0)

    def test_bad_files(self):
        code, out, err = self.against("\n- {requirement: J4-SEQ, reason: m}\n", WRONG_SEQ)
        self.assertEqual((code, out), (64, ""))
        self.assertIn("known.yaml:2: message is missing", err)  # Others: report_test.cc.
        self.refused(("check", "--expect", self.folder / "none.yaml", WRONG_SEQ),
                     "none.yaml: No such file", 66)


class Inputs(Folder):
    def rules(self, *args):
        return [finding["requirement"] for finding in failures(as_json(*args))]

    def test_stated(self):
        """A mote whose join timer is longer or shorter than the profile's."""
        lines = "".join(f"  @{t} m5 > rA am=5->1 join_request(seq_num=7 mote_type=telosb_demo "
                        "transducers=light actuators=led)\n" for t in (0, 300, 600))
        head = "%rtr 1\n%node m5 mote id=5{} iut\n%node sA sink id=1 island=11\ncase run\n"
        plain = self.write("plain.rtr", head.format("") + lines)
        stated = self.write("stated.rtr", head.format(" join_period=300") + lines)
        self.assertEqual(self.rules(plain), ["J8-PERIOD"])
        self.assertEqual(self.rules(plain, "--state", "join_period=300"), [])
        self.assertEqual(self.rules(stated), [])
        self.assertEqual(self.rules(stated, "--state", "join_period=400"), ["J8-PERIOD"])
        code, _, err = check(plain, "--state", "join_perod=300")
        self.assertEqual(code, 64)
        self.assertIn("known are response, join_period", " ".join(err.split()))

    def test_exit_codes(self):
        self.assertEqual(check(CLEAN)[0], 0)
        self.assertEqual(check(WRONG_SEQ)[0], 1)
        beacons = self.write("nothing.hex", "05 12 34\n")
        self.shows(("check", beacons), "No frames of this protocol: there is nothing to judge.",
                   code=3, err="")
        self.assertEqual(as_json(beacons)["verdict"], "inconclusive")
        foreign = self.write("foreign.hex", "00 FF FF 00 03 02 00 52 01 50\n")
        code, out, _ = check(foreign)
        self.assertEqual(code, 3)
        self.assertIn("No frame keeps or breaks a rule of RUBICON;", out)
        empty = self.write("empty", b"")
        code, out, err = check(empty)
        self.assertEqual((code, err), (3, f"rubric: {empty}: is empty\n"))
        self.assertIn("nothing could be judged", out)

    def test_a_capture_of_another_protocol_is_said(self):
        blink = self.write("blink.hex", "00 FF FF 00 00 04 22 06 00 02 00 01\n")
        says = ("its messages fit rubicon less well than blink_to_radio, "
                "which decodes 1 of its first 1")
        for args in ((blink,), ("--each", blink)):
            code, out, err = check(*args)
            self.assertEqual((code, (err + out).count(says)), (3, 1), err)
        self.assertEqual(check(CLEAN)[2], "")

    def test_a_cut_capture_is_no_pass(self):
        cut = self.write("cut.pcapng", CLEAN.read_bytes()[:-30])
        code, out, err = check(cut)
        self.assertEqual(code, 66, out)
        self.assertIn("damaged at byte", err)
        self.assertIn("Verdict: pass, but input is damaged or missing: 0 failures", out)
        self.assertNotIn("time stamps", out)
        report = as_json(cut)
        self.assertEqual((report["exit_code"], report["input_missing"]), (66, True))
        self.assertEqual(report["facts"][0], f"{cut} is damaged or cut; the rest is judged")
        [suite] = xml.etree.ElementTree.fromstring(check("--format", "junit", cut)[1])
        self.assertEqual([case.get("classname") for case in suite.findall("testcase")
                          if case.find("error") is not None], ["rubric.check.input"])
        check(cut, "--report", self.folder / "report")
        self.assertIn("<h2>Verdict: pass, but input is damaged or missing: 0 failures",
                      (self.folder / "report/index.html").read_text(encoding="utf-8"))
        code, out, _ = check("--each", cut)
        self.assertEqual(code, 66, out)
        failing = self.write("failing.pcapng", WRONG_SEQ.read_bytes() + b"x")
        self.assertEqual(check(failing)[0], 1)

    def test_a_damaged_place_leaves_the_order_of_frames(self):
        """It has no stamp of its own, which must not take the others' away."""
        whole = FIRMWARE / "b_reliable.pcapng"
        damaged = self.write("damaged.pcapng", whole.read_bytes() + bytes.fromhex("06000000"))
        known = ("--sniffer", "complete", "--start", "cold")
        wanted = as_json(whole, *known)["findings"]
        found = as_json(damaged, *known)["findings"]
        self.assertIn(("T2-CONTENT", "fail"), [(f["requirement"], f["severity"]) for f in wanted])
        self.assertEqual([f | {"file": ""} for f in found], [f | {"file": ""} for f in wanted])

    def test_unreadable(self):
        for path, says in [
            (self.folder / "none.pcapng", "No such file or directory"),
            (self.folder, "Is a directory"),
            (self.write("garbage", bytes(range(128, 256)) * 9), "is not a serial line"),
        ]:
            code, out, err = check(path)
            self.assertEqual((code, out), (66, ""), path)
            self.assertIn(str(path), err)
            self.assertIn(says, err)
            self.assertEqual(check(CLEAN, path)[0], 66)

    def test_usage(self):
        for args, says in [
            ([], "FILE is required"),
            ([CLEAN, "--profile", "papr"], "--profile"),
            ([CLEAN, "--format", "xml"], "--format"),
            ([CLEAN, "--node", "2"], "expected ID=ROLE"),
            ([CLEAN, "--node", "2=moat"], "a role is mote, sink or base-station"),
            ([CLEAN, "--node", "70000=mote"], "expected 0 to 65535"),
            ([CLEAN, "--node", "2=mote", "--node", "2=sink"], "another time"),
            ([CLEAN, "--sink", "1"], "expected ID=ISLAND"),
            ([CLEAN, "--sink", "1=65535"], "no island"),
            ([CLEAN, "--sink", "2=11", "--node", "2=mote"], "another time"),
            ([CLEAN, "--tester", "x"], "expected 0 to 65535"),
            ([CLEAN, "--response", "-1"], "--response"),
            ([CLEAN, "--frames", "5..1"], "--frames"),
            ([CLEAN, "--frames", "2:1..5"], "the run has 1 file"),
            ([CLEAN, WRONG_SEQ, "--frames", "1..5"], "of which file?"),
            ([CLEAN, "--frames", "1..5", "--frames", "7..8"], "one range for each file"),
            ([CLEAN, "--snifer", "complete"], "did you mean '--sniffer'?"),
        ]:
            self.refused(("check", *args), says)

    def test_help(self):
        code, out, _ = check("--help")
        self.assertEqual(code, 0)
        for words in ["64 usage", "66 input cannot be read", "--expect", "--sniffer"]:
            self.assertIn(words, out)

    def test_stdin(self):
        self.shows(("check", "-"), "FAIL J4-SEQ, mote 2, frame 3", code=1,
                   stdin=WRONG_SEQ.read_bytes())
        self.assertEqual(check("-")[::2], (3, "rubric: stdin: is empty\n"))

    def test_frames(self):
        self.assertEqual(as_json(WRONG_SEQ, "--frames", "1..2")["counts"]["fail"], 0)
        self.assertEqual(as_json(WRONG_SEQ, "--frames", "1..3")["counts"]["fail"], 1)
        both = as_json(CLEAN, WRONG_SEQ, "--frames", "1:none", "--frames", "2:1..3")
        self.assertEqual([(f["file"], f["frame"]) for f in failures(both)], [(str(WRONG_SEQ), 3)])

    def test_input_format(self):
        serial = FIRMWARE / "b_reliable.serial.bin"
        self.assertEqual(as_json("--input-format", "hdlc", serial), as_json(serial))
        hex_frames = self.write("air.hex", "41881d220001000200 04 c4f5 01 0007 0001\n")
        self.assertEqual(as_json("--input-format", "hex-radio", hex_frames)["counts"]["frames"], 1)

    def test_application_log_beside_its_capture(self):
        air, log = self.folder / "air.pcapng", self.folder / "run.rtr"
        rubric("simulate", "--scenario", "open_door", "--out-pcapng", air, "--out-rtr", log)
        lines = [line for line in log.read_text().splitlines()
                 if not line.lstrip().startswith("@") or re.search(r"[<>] +app ", line)]
        app = self.write("app.rtr", "\n".join(lines) + "\n")
        code, out, err = check(air, app, "--sniffer", "complete", "--start", "cold")
        self.assertEqual((code, err), (0, ""), out)
        self.assertIn("application log", out)
        # The frames that the log has as well give way.
        for whole in "", " whole":
            text = re.sub("(%node .*)", rf"\1{whole}", log.read_text())
            both = self.write("both.rtr", text)
            code, out, err = check(air, both, "--sniffer", "complete", "--start", "cold")
            self.assertEqual((code, err), (0, ""), out)
            self.assertIn(f"{both}: its frames on the air are left out, as {air} has them",
                          " ".join(out.split()))
            wrong = self.write("wrong.rtr", text.replace("joined(address=11:4 result=success)",
                                                         "joined(address=11:9 result=success)"))
            found = failures(as_json(air, wrong))
            self.assertEqual([(one["requirement"], one["file"]) for one in found],
                             [("J5-SUCCESS", str(wrong))])

    def test_a_log_says_which_requests_the_sink_missed(self):
        air, log = self.folder / "air.pcapng", self.folder / "run.rtr"
        rubric("simulate", "--loss", "0.2", "--seed", "14", "--seconds", "6", "--out-pcapng", air,
               "--out-rtr", log)
        text = log.read_text()
        self.assertEqual(len(re.findall("lost am=2->1 join_request", text)), 3)
        self.assertEqual(as_json(air, log)["findings"], [])
        given = self.write("given.rtr", re.sub("rA +lost (am=2->1 join_request)", r"sA < rA \1",
                                               text, count=1))
        found = as_json(air, given)["findings"]
        self.assertEqual([(one["requirement"], one["severity"]) for one in found],
                         [("J9-INTERLEAVE", "inconclusive")])

    def test_no_explanation_comes_twice(self):
        run = self.folder / "run.pcapng"
        rubric("simulate", "--motes", "3", "--out-pcapng", run)
        frames = [json.loads(line) for line in
                  rubric("decode", run, "--format", "jsonl")[1].splitlines()]
        for frame in [one for one in frames if one["message"] == "ack_join"][:2]:
            frame["fields"]["seq_num"] += 1
            del frame["raw"]
            frame["frame"].pop("fcs", None)
        lines = "".join(json.dumps(frame) + "\n" for frame in frames)
        wrong = self.folder / "wrong.pcapng"
        self.assertEqual(rubric("encode", "--format", "pcapng", "-o", wrong, stdin=lines)[0], 0)
        found = [one for one in failures(as_json(wrong)) if one["requirement"] == "J6-SEQ"]
        self.assertTrue(found)
        for one in found:
            said = [json.dumps(hypothesis) for hypothesis in one["hypotheses"]]
            self.assertEqual(sorted(said), sorted(set(said)))

    def test_testers_are_not_judged(self):
        self.assertEqual(as_json(WRONG_SEQ, "--tester", "2")["counts"]["fail"], 0)


if __name__ == "__main__":
    unittest.main()
