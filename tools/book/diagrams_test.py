#!/usr/bin/env python3
"""The book's diagrams: well formed, named, without colours of their own, the same each time, and
with every transition and every rule in them.

Usage: diagrams_test.py RUBRIC.
"""

import json
import pathlib
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree

import diagrams

RUBRIC = str(pathlib.Path(sys.argv.pop(1)).resolve())
SVG = "{http://www.w3.org/2000/svg}"


def words_of(svg):
    """All that a reader can read in it."""
    root = xml.etree.ElementTree.fromstring(svg)
    texts = ["".join(text.itertext()) for text in root.iter(SVG + "text")]
    return " ".join(texts).replace("\u00a0", " ")


def parts():
    done = subprocess.run([RUBRIC, "explore", "--transitions", "--format", "json"], check=True,
                          stdout=subprocess.PIPE, text=True)
    return {part["name"]: part for part in json.loads(done.stdout)["parts"]}


class Diagrams(unittest.TestCase):
    def test_each_part_has_one(self):
        found = parts()
        self.assertEqual({name: part["title"] for name, part in found.items()}, diagrams.STATES)
        for name, part in found.items():
            words = words_of(diagrams.states_svg(RUBRIC, name))
            self.assertNotIn("&", words)
            for transition in part["transitions"]:
                for one in [transition["trigger"], *transition["guards"],
                            *transition["outputs"], *transition["rules"]]:
                    self.assertIn(one, words)

    def test_they_are_elements_for_a_page(self):
        for svg, name in [(diagrams.states_svg(RUBRIC, "join"), "states-join"),
                          (diagrams.chart_svg(RUBRIC, "j4.accept"), "chart-j4.accept")]:
            self.assertTrue(svg.startswith("<svg "))
            self.assertNotRegex(svg, r"<\?|<!|<script|xlink")
            root = xml.etree.ElementTree.fromstring(svg)
            for one in root.iter():
                self.assertTrue(one.get("id", name).startswith(name))
                if not one.tag.endswith("style"):
                    self.assertEqual([one.get(key) for key in ("fill", "stroke", "font-family")],
                                     [None] * 3, one.tag)
            self.assertTrue(root.find(SVG + "title").text)

    def test_rules_lead_where_the_book_says(self):
        for svg in (diagrams.states_svg(RUBRIC, "join", "#rule-{}".format),
                    diagrams.chart_svg(RUBRIC, "j4.wrong_seq", "#rule-{}".format)):
            xml.etree.ElementTree.fromstring(svg)
            self.assertIn('<a href="#rule-J4-SEQ"><tspan class="rc-rule">J4-SEQ</tspan></a>', svg)
            linked = re.findall(r'<a href="#rule-([^"]+)">', svg)
            named = re.findall(r"\b[JNTS]\d+-[A-Z]+\b", words_of(svg))
            self.assertEqual(sorted(linked), sorted(named))

    def test_they_are_the_same_each_time(self):
        self.assertEqual(diagrams.states_svg(RUBRIC, "join"), diagrams.states_svg(RUBRIC, "join"))

    def test_what_does_not_exist(self):
        with self.assertRaisesRegex(RuntimeError, "did you mean 'j4.accept'"):
            diagrams.chart_svg(RUBRIC, "j4.acept")
        with self.assertRaises(KeyError):
            diagrams.states_svg(RUBRIC, "nothing")


if __name__ == "__main__":
    unittest.main()
