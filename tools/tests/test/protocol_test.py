#!/usr/bin/env python3
"""`rubric new-protocol`, and test, shrink and diff with `--protocol`.

Usage: protocol_test.py RUBRIC
"""

import json
import pathlib
import shutil
import unittest
import xml.etree.ElementTree

import testing

CTP = pathlib.Path("conformance/protocols/ctp").resolve()
CTP_NODE = f"python3 {CTP}/node.py"


class Protocol(testing.Folder):
    def setUp(self):
        super().setUp()
        self.cwd = self.folder

    def rubric(self, *words):
        return testing.rubric(*words, cwd=self.folder)

    def new(self):
        """A folder that new-protocol has just written, and a node whose mistake it names."""
        self.shows(("new-protocol", "probes"),
                   "rubric test --protocol probes --target 'python3 probes/node.py'", err="")
        return self.folder / "probes"

    def change(self, path, old, new):
        text = path.read_text()
        self.assertEqual(text.count(old), 1, old)
        path.write_text(text.replace(old, new))

    def broken_node(self, probes):
        shutil.copytree(probes, self.folder / "broken")
        self.change(self.folder / "broken/node.py", "dest == self.id and payload", "payload")
        return "python3 broken/node.py"

    def test_a_new_one_is_green(self):
        self.new()
        self.shows(("test", "--protocol", "probes", "--target", "python3 probes/node.py",
                    "--require-rules", 3), "probes_python 1.0 plays node; 2 cases\n",
                   "Of 3 rules 3 tried: 3 kept, 0 broken, 0 not decided.", err="")
        names = {str(path.relative_to(self.folder)) for path in self.folder.rglob("*")}
        self.assertTrue({"probes/probes.ksy", "probes/cases/probes.rtr"} <= names, names)
        self.refused(("new-protocol", "probes"), "it exists, and may hold your work", code=74)
        for name in ("Probes", "7up", "a-b", ""):
            self.assertEqual(self.rubric("new-protocol", name)[0], 64, name)

    def test_a_trace_that_cannot_be_read_is_named(self):
        probes = self.new()
        (probes / "cases/more.rtr").symlink_to("nowhere")
        self.shows(("test", "--protocol", "probes", "--list"), code=66,
                   err="probes/cases/more.rtr: No such file or directory")
        (self.folder / "endless.rtr").symlink_to("/dev/zero")
        code, _, err = self.rubric("test", "--protocol", "probes", "--list", "endless.rtr")
        self.assertEqual((code, err), (66, "rubric: endless.rtr: File too large\n"))

    def test_decode_reads_its_frames(self):
        self.new()
        (self.folder / "frame.hex").write_text("00 00 01 00 05 03 00 a2 07 00 d7\n")
        self.shows(("decode", "--spec", "probes/probes.ksy", "frame.hex"),
                   "reading                 number=7 value=215")

    def test_a_mistake_is_found_by_its_rule_in_all_reports(self):
        broken = self.broken_node(self.new())
        code, out, _ = self.rubric("test", "--protocol", "probes", "--target", broken, "--report",
                                   "report", "--write-expect", "known.yaml")
        self.assertEqual(code, 1)
        self.assertIn("Rule:     A node does not answer a request for another node. "
                      "(MUST ANSWER-OTHERS;", out)
        report = self.folder / "report"
        data = json.loads((report / "report.json").read_text())
        self.assertEqual((data["protocol"], data["profile"]), ("probes", ""))
        failed = [case for case in data["implementations"][0]["cases"] if case["verdict"] == "fail"]
        self.assertEqual([case["failures"][0]["requirements"] for case in failed],
                         [["ANSWER-OTHERS"]])
        self.assertEqual(failed[0]["roles"], ["node"])
        failures = xml.etree.ElementTree.parse(report / "junit.xml").findall(".//failure")
        self.assertIn("ANSWER-OTHERS", failures[0].get("message"))
        self.assertIn("not ok 2 - probes_python 1.0: answer.others",
                      (report / "report.tap").read_text())
        page = (report / "index.html").read_text()
        self.assertIn('"roles":["node"]', page)
        self.assertIn("rubric test --protocol probes --target 'python3 broken/node.py' "
                      "--cases answer.others", page.replace("\\u0027", "'"))
        self.assertIn("requirement: ANSWER-OTHERS", (self.folder / "known.yaml").read_text())
        text = (self.folder / "known.yaml").read_text().replace('reason: ""', "reason: known")
        (self.folder / "known.yaml").write_text(text)
        self.shows(("test", "--protocol", "probes", "--target", broken, "--expect", "known.yaml"),
                   err="")

    def test_a_log_is_a_case(self):
        broken = self.broken_node(self.new())
        self.rubric("test", "--protocol", "probes", "--target", broken, "--report", "report")
        logs = sorted((self.folder / "report").rglob("*.rtr"))
        self.assertTrue(logs)
        for log in logs:
            self.shows(("test", "--protocol", "probes", "--list", log), err="")

    def test_shrink_and_diff_work_by_targets_alone(self):
        broken = self.broken_node(self.new())
        good = "python3 probes/node.py"
        trace = self.folder / "long.rtr"
        trace.write_text("%rtr 1\n%node n5 node id=5 iut\n%node n1 node id=1\ncase long\n"
                         "   0      n5 < app measured(3)\n"
                         "   100    n5 < rA am=1->5 request(number=1)\n"
                         "   0..50  n5 > rA am=5->1 reading(number=1 ...) [ANSWER-NUMBER]\n"
                         "a: 300    n5 < rA am=1->6 request(number=2)\n"
                         "   a+0..90 n5 !> rA reading(*) [ANSWER-OTHERS]\n")
        code, out, err = self.rubric("shrink", "--protocol", "probes", trace, "--target", broken,
                                     "--reference", good)
        self.assertEqual(code, 0, err)
        self.assertIn("2 of the 5 lines of long.", out)
        self.assertIn("ANSWER-OTHERS", out)
        self.shows(("shrink", "--protocol", "probes", trace, "--target", broken, "--reference",
                    broken), code=64,
                   err="--reference: probes_python 1.0 does not pass the trace itself")
        self.shows(("diff", "--protocol", "probes", "--target", good, "--target", broken),
                   "case answer.others.difference", code=1, err="2 cases compared, 1 differ")

    def test_text_and_bits_are_compared(self):
        probes = self.new()
        (probes / "probes.ksy").write_text(
            "meta: {id: probes, endian: be, encoding: UTF-8}\n"
            "types:\n"
            "  request:\n    -am-type: 0xa1\n    seq:\n"
            "      - {id: loud, type: b1}\n      - {id: size, type: b7}\n"
            "      - {id: who, type: str, size: size}\n"
            "  reading:\n    -am-type: 0xa2\n    seq:\n"
            "      - {id: loud, type: b1}\n      - {id: size, type: b7}\n"
            "      - {id: parts, size: size}\n      - {id: who, type: strz}\n")
        self.change(probes / "app.yaml", "asked: {by: u2}", "asked: {who: bytes}")
        node = probes / "node.py"
        self.change(node, "by=src", "who=payload[1:]")
        self.change(node, "self.answer(src, payload[0])", "self.answer(src, payload[1:])")
        self.change(node, 'struct.pack(">BH", number, self.value)',
                    'b"\\x81\\x07" + number + b"\\0"')
        case = probes / "cases/probes.rtr"
        case.write_text(
            "%rtr 1\n%node n5 node id=5 iut\n%node n1 node id=1\ncase a\n"
            '0 n5 < rA am=1->5 request(loud=0 size=4 who="Gr\u00fc")\n'
            '0..response n5 > app asked("Gr\u00fc")  [ANSWER-NUMBER]\n'
            '0..response n5 > rA reading(loud=1 size=1 parts=x07 who="Gr\u00fc")  [ANSWER-VALUE]\n'
            "50 n5 < rA am=1->5 request(loud=1 size=2 who=x4142)\n"
            "0..response n5 > rA reading(who=$w ...)\n"
            "50 n5 < rA am=1->5 request(size=2 who=$w ...)\n"
            "0..response n5 > app asked($w)\n"
            "0..response n5 > rA reading(who=x414200 ...)  [ANSWER-OTHERS]\n")
        judge = ("test", "--protocol", "probes", "--target", "python3 probes/node.py")
        code, out, err = self.rubric(*judge)
        self.assertEqual((code, err), (0, ""), out)
        for old, new, expected in [
                (r"\x81", r"\x01", "ANSWER-VALUE"), (r"\0", "", "ANSWER-VALUE"),
                ("+ number +", "+ number.upper() +", "ANSWER-VALUE"),
                ("who=payload[1:]", "who=payload", "ANSWER-NUMBER")]:
            with self.subTest(old):
                before = node.read_text()
                self.change(node, old, new)
                code, out, err = self.rubric(*judge)
                node.write_text(before)
                self.assertEqual((code, err), (1, ""), out)
                self.assertIn(f"  Broken: {expected}\n", out)
        for old, new, expected in [
                ("size=4", "size=128", ":5:34: size: expected a number from 0 to 127, given '128'"),
                ("Gr\u00fc\")\n0..response n5 > app", "Gr\\xff\")\n0..response n5 > app", "UTF-8")]:
            before = case.read_text()
            self.change(case, old, new)
            code, out, err = self.rubric(*judge)
            case.write_text(before)
            self.assertIn(expected, out + err)

    def test_parameters_are_built_or_skipped(self):
        probes = self.new()
        case = probes / "cases/probes.rtr"
        self.change(case, "%node n5 node id=5 iut", "%node n5 node id=5 iut response=20")
        self.shows(("test", "--protocol", "probes", "--target", "python3 probes/node.py",
                    "--format", "tap"), "it is not built with response=20", code=3)
        self.change(probes / "node.py", 'serve(Node, "probes_python", ["node"])',
                    'serve(Node, "probes_python", ["node"], response=100)')
        self.change(probes / "node.py", "def __init__(self, world, role, id, seed):",
                    "def __init__(self, world, role, id, seed, response):")
        code, out, _ = self.rubric("test", "--protocol", "probes", "--target",
                                   "python3 probes/node.py")
        self.assertEqual(code, 0, out)

    def test_mistakes_have_their_places(self):
        probes = self.new()
        case, rules, app = (probes / name for name in
                            ("cases/probes.rtr", "requirements.yaml", "app.yaml"))
        for path, old, new, expected in [
                (case, "number=7 ...", "nummer=7 ...", ":10:44: reading has no field 'nummer' (did "
                 "you mean 'number'?)"),
                (case, "measured(220)", "measure(220)", ":11:28: unknown message 'measure' (did "
                 "you mean 'measured'?)"),
                (case, "%node n1 node", "%node n1 sink", ":4:10: expected node, given 'sink'"),
                (case, "[ANSWER-VALUE]", "[ANSWER-VALUES]",
                 ":13:4: no requirement 'ANSWER-VALUES'"),
                (case, "%rtr 1", "%rtr 1 %profile paper", ":2:8: probes has no profiles"),
                (rules, "level: MUST\n  clause: answers\n  sentence: \"A node answers",
                 "level: SHALL\n  clause: answers\n  sentence: \"A node answers",
                 ":3:10: error: level is 'SHALL'"),
                (app, "calls:", "callls:", ":12:1: 'callls' is no key of a protocol; known are"),
                (app, "probes.ksy", "nothing.ksy", ":3:7: no file probes/nothing.ksy"),
                (app, "wire: probes.ksy", "wire: ''", ":3:7: expected a .ksy file of the folder"),
                (rules, "- id: ANSWER-NUMBER\n", "- id: ANSWER-NUMBER\n  roles: [node]\n",
                 ":3:3: error: unknown key 'roles' of a requirement; known are id"),
                (app, "probes.ksy", "probs",
                 ":3:7: expected a .ksy file of the folder, or a shipped"),
                (app, "probes.ksy", "osciloscope", "(did you mean 'oscilloscope'?)"),
                (app, "probes.ksy", "list", "given 'list'"),
                (probes / "probes.ksy", "type: u2", "type: u3", "unknown type 'u3'")]:
            with self.subTest(new):
                before = path.read_text()
                self.change(path, old, new)
                code, _, err = self.rubric("test", "--protocol", "probes", "--target", "true")
                path.write_text(before)
                self.assertIn(code, (64, 66), err)
                self.assertIn(expected, err)
        for words, expected in [
                (("--protocol", "nowhere"), "nowhere/app.yaml"),
                (("--protocol", "probes", "--profile", "deployed"),
                 "--profile: probes has no profile deployed"),
                (("--protocol", "probes", "--role", "sink"),
                 "--role: expected one of node; given 'sink'"),
                (("--protocol", "probes", "--state", "members=3"),
                 "'members' is no parameter that can be stated; known are response"),
                (("--protocol", "probes", "--target", "machine"), "are for RUBICON; probes needs"),
                (("--protocol", "probes", "--rule", "J4"), "no rule is called 'J4'")]:
            with self.subTest(words):
                code, _, err = self.rubric("test", "--target", "true", *words)
                self.assertIn(code, (64, 66), err)
                self.assertIn(expected, err)

    def test_who_agrees_to_everything_is_refused(self):
        self.new()
        (self.folder / "liar.py").write_text(
            "import sys\n"
            "for line in sys.stdin:\n"
            "    words = line.split()\n"
            "    if words[0] == 'hello': print('hello rct/1 liar 1 roles=node time=virtual')\n"
            "    elif words[0] == 'reset': print('ready')\n"
            "    elif words[0] == 'bye': break\n"
            "    elif words[0] == 'until': print('done', words[1])\n"
            "    else: print('done 0')\n"
            "    sys.stdout.flush()\n")
        self.shows(("test", "--protocol", "probes", "--target", "python3 liar.py"),
                   "it does not refuse an unknown command", code=2)

    def test_rubicon_is_as_it_was(self):
        self.shows(("test", "--list", "--rule", "J4-SEQ"), "j4.wrong_seq", err="")

    def test_rules_and_cases_are_shown(self):
        out = self.shows(("explain", "--protocol", CTP, "pull", "DATA-NEW-THL"),
                         "PULL-ASK: SHOULD, routing pull", "positive: data.new_thl", err="")
        self.assertNotIn("machine:", out)
        self.shows(("chart", "--protocol", CTP, "beacon.etx", "--target", CTP_NODE), "ctp_routing",
                   err="")
        self.shows(("chart", "--protocol", CTP, "beacon.etx"), code=64, err="give --target")

    def test_each_rule_of_ctp_has_a_case(self):
        code, out, _ = self.rubric("test", "--protocol", CTP, "--list", "--format", "json")
        self.assertEqual(code, 0)
        tried = {rule for case in json.loads(out)["cases"] for rule in case["rules"]}
        rules = [line.split()[2] for line in (CTP / "requirements.yaml").read_text().splitlines()
                 if line.startswith("- id: ")]
        self.assertEqual(sorted(tried), sorted(rules))
        self.assertGreaterEqual(len(rules), 20)
        sources = [line for line in (CTP / "requirements.yaml").read_text().splitlines()
                   if line.startswith("  source: ")]
        self.assertEqual(len(sources), len(rules))
        for source in sources:
            self.assertRegex(source, r"TEP 1(19|23), (section \d|abstract)")


if __name__ == "__main__":
    unittest.main()
