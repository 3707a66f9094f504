#!/usr/bin/env python3
"""Holds paper.yaml: no paragraph is left out, and rules and decisions named are there.

Usage: paper_test.py PROJECT_FOLDER
"""

import pathlib
import re
import sys
import unittest

import yaml

SPEC = pathlib.Path(sys.argv.pop(1)) / "spec"

# The clauses of the three chapters, and how many paragraphs each has in the paper, counted there.
PARAGRAPHS = {
    "Overview of the Communication Layer": 1,
    "A Reference Architecture for Cognitive Robotic Ecologies": 7,
    "Communication Requirements": 8,
    "The Structure of the Communication Layer": 3,
    "The Network level": 5,
    "The Topology and the Routing of the Ecology": 3,
    "The Intra-Island Connectivity": 1,
    "The Inter-Island Connectivity": 3,
    "The RUBICON Addressing Scheme": 5,
    "Island Collision Resolution and Safe Join": 6,
    "The Transport level": 11,
    "Connectionless Message Passing": 3,
    "Synaptic Communication": 16,
    "Message Dispatcher": 9,
    "Rubicon ACK": 5,
    "Component Management": 7,
    "Memory Occupation": 6,
    "Test-Bed Case Studies": 2,
    "In-Hospital Transport Test-Bed": 11,
    "AAL Test-bed": 16,
}


def load(path):
    return yaml.safe_load((SPEC / path).read_text(encoding="utf-8"))


def number_of(paragraph):
    return next(iter(paragraph))


class Paper(unittest.TestCase):
    def setUp(self):
        self.sources = {rule["id"]: rule["source"] for rule in load("requirements.yaml")}
        self.decisions = {int(path.name[:4]) for path in (SPEC / "decisions").glob("[0-9]*.md")}
        self.clauses = {one["clause"]: one["paragraphs"] for one in load("rules/paper.yaml")}

    def paragraphs(self):
        for clause, paragraphs in self.clauses.items():
            for one in paragraphs:
                yield f"{clause}, {number_of(one)}", one

    def test_clauses_and_paragraphs_are_those_of_the_paper(self):
        self.assertEqual([one["clause"] for one in load("rules/paper.yaml")], list(PARAGRAPHS))
        for clause, paragraphs in self.clauses.items():
            self.assertEqual([number_of(one) for one in paragraphs],
                             list(range(1, PARAGRAPHS[clause] + 1)), clause)

    def test_every_paragraph_is_covered_or_not_judged(self):
        for place, one in self.paragraphs():
            self.assertIn(set(one) - {number_of(one)}, ({"covers"}, {"not_judged"}), place)
            self.assertTrue(one[number_of(one)].strip(), place)
            self.assertTrue(one.get("covers") or one.get("not_judged"), place)
            self.assertEqual(len(one.get("covers", [])), len(set(one.get("covers", []))), place)

    def test_what_is_named_exists(self):
        for place, one in self.paragraphs():
            for name in one.get("covers", []) + [one.get("not_judged", 138)]:
                known = self.decisions if isinstance(name, int) else self.sources
                self.assertIn(name, known, place)

    def test_every_rule_of_the_paper_is_reached_in_its_clause(self):
        for rule, source in self.sources.items():
            for clause in re.findall(r"paper: ([^;]+)", source):
                self.assertIn(clause, self.clauses, rule)
                reached = [one for one in self.clauses[clause] if rule in one.get("covers", [])]
                self.assertTrue(reached, f"no paragraph of {clause} covers {rule}")

    def test_every_reading_of_the_paper_is_reached(self):
        named = {name for _, one in self.paragraphs()
                 for name in one.get("covers", []) + [one.get("not_judged")]}
        missing = {one for one in self.decisions if one > 100} - named
        self.assertEqual(missing, set(), "no paragraph names these decisions")


if __name__ == "__main__":
    unittest.main()
