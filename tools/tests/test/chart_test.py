#!/usr/bin/env python3
"""`rubric chart`: every golden trace as text and as a picture, compared with the log of its run.

Usage: chart_test.py RUBRIC, in the project's folder.
"""

import concurrent.futures
import json
import pathlib
import re
import tempfile
import unittest
import xml.etree.ElementTree

from testing import ROOT, Folder, run

SVG = "{http://www.w3.org/2000/svg}"
LABEL, SMALL = 7.3, 6.7  # Pixels a character, as the picture counts them.


def chart(*words):
    return run("chart", *words, text=True)


def picture(case):
    done = chart(case, "--format", "svg")
    if done.returncode != 0 or done.stderr:
        raise AssertionError(f"{case}: {done.stderr}")
    return xml.etree.ElementTree.fromstring(done.stdout)


def rows_of(svg):
    return [group for group in svg.iter(SVG + "g") if group.get("class") == "rc-row"]


def label_of(row):
    return next(text for text in row.iter(SVG + "text") if "rc-label" in text.get("class"))


def box_of(text):
    """Left, right and baseline of a text that the picture writes."""
    x, y = float(text.get("x")), float(text.get("y"))
    kind = text.get("class").split()
    width = (LABEL if "rc-label" in kind else SMALL) * len("".join(text.itertext()))
    if "rc-middle" in kind:
        x -= width / 2
    elif "rc-time" in kind:
        x -= width
    return x, x + width, y


class EveryCase(unittest.TestCase):
    """Each golden trace of the kit, drawn once for all tests."""

    @classmethod
    def setUpClass(cls):
        listed = json.loads(run("test", "--list", "--format", "json", text=True).stdout)["cases"]
        cls.cases = [one["name"] for one in listed]
        with tempfile.TemporaryDirectory() as folder:
            run("test", "--target", "machine", "--report", folder, "--quiet")
            cls.logs = {}
            for path in pathlib.Path(folder).rglob("*.rtr"):
                text = path.read_text()
                case = re.search(r"^case (\S+)", text, re.M)[1]
                cls.logs[case] = re.findall(r"^\s*@(\d+)\s+(\S+)\s+([<>])\s+(\S+)\s+(?:am=\S+ )?"
                                            r"([a-z_]+|\*)", text, re.M)
        # By file: for a case's name alone, the program reads all files that it contains.
        places = [f"{one['file']}:{one['name']}" for one in listed]
        files = sorted({one["file"] for one in listed})
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            cls.pictures = dict(zip(cls.cases, pool.map(picture, places)))
            cls.texts = dict(zip(files, pool.map(chart, files)))

    def test_each_is_there(self):
        self.assertGreater(len(self.cases), 250)
        self.assertEqual(set(self.cases), set(self.logs))

    def test_each_line_of_the_log_is_drawn_once(self):
        for case, svg in self.pictures.items():
            rows = rows_of(svg)
            drawn = sorted(int(i) for row in rows for i in row.get("data-lines").split())
            self.assertEqual(drawn, list(range(len(self.logs[case]))), case)
            for row in rows:
                tick, node, *_, message = self.logs[case][int(row.get("data-lines").split()[0])]
                self.assertTrue(row.find(SVG + "title").text.startswith(f"@{tick}"), case)
                self.assertIn(node, row.find(SVG + "title").text)
                label = "".join(label_of(row).itertext())
                self.assertTrue(label.startswith(message) or label.startswith("ack "),
                                f"{case}: {label}")

    def test_text_has_a_line_for_each_row(self):
        found = []
        for file, done in self.texts.items():
            self.assertEqual((done.returncode, done.stderr), (0, ""), file)
            for case, text in re.findall(r"^(\S+): (.*\n(?:[ \n].*\n*)*)", done.stdout, re.M):
                found.append(case)
                lines = re.findall(r"^ +\d+  .*\S$", text, re.M)
                self.assertEqual(len(lines), len(rows_of(self.pictures[case])), case)
                for line in lines:
                    self.assertRegex(line, r"[|*]")
        self.assertEqual(sorted(found), sorted(self.cases))

    def test_pictures_name_themselves(self):
        for case, svg in self.pictures.items():
            self.assertEqual(svg.get("role"), "img")
            ids = [one.get("id") for one in svg.iter() if one.get("id")]
            self.assertEqual(ids, [f"chart-{case}-title", f"chart-{case}-desc"])
            self.assertEqual(svg.get("aria-labelledby"), " ".join(ids))
            self.assertIn(case, svg.find(SVG + "title").text)
            self.assertTrue(svg.find(SVG + "desc").text)
            self.assertEqual([one.tag for one in svg.iter() if one.tag.endswith("script")], [])

    def test_no_text_meets_another_or_the_edge(self):
        for case, svg in self.pictures.items():
            width, height = float(svg.get("width")), float(svg.get("height"))
            lines = {}
            for row in rows_of(svg):
                for text in row.iter(SVG + "text"):
                    left, right, y = box_of(text)
                    self.assertGreaterEqual(left, 0, case)
                    self.assertLessEqual(right, width, case)
                    self.assertLess(y, height, case)
                    lines.setdefault(round(y / 4), []).append((left, right))
            for boxes in lines.values():
                boxes.sort()
                for (_, end), (begin, _) in zip(boxes, boxes[1:]):
                    self.assertLessEqual(end, begin + 1, case)


class Chart(Folder):
    """Single cases, and the command line."""

    def test_what_is_ignored_says_why(self):
        text = chart("j4.wrong_seq").stdout
        self.assertRegex(text, r"\|<-+\|-+join_reply 1001-+\|  \[ignored: J4-SEQ\]")
        svg = chart("j4.wrong_seq", "--format", "svg").stdout
        self.assertIn('ignored: <tspan class="rc-rule">J4-SEQ</tspan>', svg)
        self.assertEqual(svg.count('class="rc-open" d='), 1)  # A hollow head.

    def test_a_reboot_is_a_mark_at_its_node(self):
        row = next(row for row in rows_of(picture("more_j.member_after_a_reboot"))
                   if "".join(label_of(row).itertext()) == "reboot")
        self.assertEqual([one.get("class") for one in row.iter(SVG + "rect")], ["rc-open"])
        self.assertEqual(list(row.iter(SVG + "line")), [])
        self.assertRegex(chart("more_j.member_after_a_reboot").stdout, r"\| +\*  reboot")

    def test_what_nobody_hears_is_crossed_out(self):
        lost = [row for row in rows_of(picture("open_door.lost"))
                if any(one.get("class") == "rc-lost" for one in row.iter(SVG + "path"))]
        self.assertEqual(len(lost), 1)
        self.assertIn("not heard by m7", "".join(lost[0].itertext()))
        self.assertIn("not heard by m7", chart("open_door.lost").stdout)

    def test_long_silence_is_a_pause(self):
        svg = picture("more_j.member_after_a_reboot")
        ticks = sorted({int(re.match(r"@(\d+)", row.find(SVG + "title").text)[1])
                        for row in rows_of(svg)})
        pauses = sum(b - a > 100 for a, b in zip(ticks, ticks[1:]))
        drawn = {one.get("y1") for one in svg.iter(SVG + "line") if one.get("class") == "rc-pause"}
        self.assertEqual(len(drawn), pauses)
        self.assertGreater(pauses, 1)

    def test_it_is_the_same_each_time(self):
        for words in (["two_sinks"], ["two_sinks", "--format", "svg"]):
            self.assertEqual(chart(*words).stdout, chart(*words).stdout)

    def test_files(self):
        path = str(ROOT / "conformance/cases/j4.rtr")
        one = chart(path + ":j4.wrong_seq")
        self.assertEqual(one.stdout, chart("j4.wrong_seq").stdout)
        self.shows(("chart", path), one.stdout)
        done = chart(path, "--format", "svg")
        self.assertEqual(done.returncode, 64)
        self.assertRegex(done.stderr, r"has \d+ cases; name the one to draw: \S+:j4\.accept")
        out = self.folder / "chart.svg"
        self.assertEqual(chart("j4.accept", "--format", "svg", "--out", out).returncode, 0)
        xml.etree.ElementTree.parse(out)
        self.assertEqual(chart("j4.accept", "--out", self.folder / "none/x").returncode, 74)

    def test_what_does_not_exist(self):
        for words, code, text in [
                (["j4.wrongseq"], 64, "did you mean 'j4.wrong_seq'"),
                (["conformance/cases/j4.rtr:j4.acept"], 64, "did you mean 'j4.accept'"),
                (["no_such.rtr"], 66, "no_such.rtr: No such file"),
                (["j4.accept", "--target", "machine:no_fial"], 64, "no_fial"),
                ([""], 64, "")]:
            with self.subTest(words=words):
                self.refused(("chart", *words), text, code)

    def test_a_broken_file_says_where(self):
        path = self.write("mine.rtr", "%rtr 1\ncase x\n@0 m5 < app jion(telosb_demo 0 0)\n")
        self.refused(("chart", path), "mine.rtr:3:", 66)

    def test_other_implementations(self):
        done = chart("j4.wrong_seq", "--target", "machine:accepts_wrong_seq")
        self.assertEqual(done.returncode, 1)
        self.assertIn("conformance/cases/j4.rtr:", done.stderr)
        self.assertRegex(done.stdout, r" 2   \|<-+joined success-+\|")
        self.assertRegex(chart("j4.wrong_seq").stdout, r" 100   \|<-+joined success-+\|")


if __name__ == "__main__":
    unittest.main()
