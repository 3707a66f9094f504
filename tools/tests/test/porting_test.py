#!/usr/bin/env python3
"""conformance/PORTING.md shows what happens: the loop, the conversations, the failure.

Usage: porting_test.py RUBRIC [--regenerate]
--regenerate writes the loop and the failure into the text.
"""

import fnmatch
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

from readme.number import readme_number
from testing import ROOT, RUBRIC, run

PORTING = ROOT / "conformance/PORTING.md"
TEXT = PORTING.read_text(encoding="utf-8")
ADAPTER = ROOT / "conformance/adapters/python"


RENEW = f"Renew with: python3 tools/tests/test/porting_test.py {RUBRIC} --regenerate"
FENCED = re.compile(r"^```([^\n]*)\n(.*?)^```\n", re.M | re.S)


def blocks(language):
    return [block for name, block in FENCED.findall(TEXT) if name == language]


def rubric(*words, folder=ROOT):
    return run(*words, cwd=folder, text=True, env={"GITHUB_ACTIONS": ""})


LINES_MAX = readme_number("adapter of # lines around it")


def loop():
    return (ADAPTER / "adapter.py").read_text(encoding="utf-8")


def failure():
    """The report on the mote of the adapter, but for one mistake."""
    bugs = json.loads((ADAPTER / "bugs.json").read_text(encoding="utf-8"))
    bug = next(bug for bug in bugs if bug["requirement"] == "J4-SEQ")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("adapter.py", "words.py", "mote.py"):
            shutil.copy(ADAPTER / name, folder)
        mote = pathlib.Path(folder) / bug["file"]
        mote.write_text(mote.read_text().replace(bug["old"], bug["new"]))
        tried = rubric("test", "--target", "python3 adapter.py", "--rule", "J4-SEQ",
                       "--quiet", folder=folder)
    if tried.returncode != 1:
        raise RuntimeError(f"rubric test ended with {tried.returncode}\n{tried.stderr}")
    return ("$ rubric test --target 'python3 adapter.py' --rule J4-SEQ --quiet\n" +
            tried.stdout)


def regenerate():
    def renewed(block):
        language, text = block.groups()
        if language == "python":
            text = loop()
        elif not language and text.startswith("$ rubric test"):
            text = failure()
        return f"```{language}\n{text}```\n"
    PORTING.write_text(FENCED.sub(renewed, TEXT), encoding="utf-8")


class Porting(unittest.TestCase):
    def test_loop_is_that_of_the_adapter(self):
        self.assertIn("def answer", loop())
        self.assertLessEqual(len(loop().splitlines()), LINES_MAX)
        self.assertEqual([loop()], blocks("python"), RENEW)

    def test_conversations(self):
        conversations = re.findall(r"^    > hello.*\n(?:    [<>] .*\n)+", TEXT, re.M)
        self.assertGreaterEqual(len(conversations), 1)
        for text in conversations:
            lines = [line.strip() for line in text.splitlines()]
            given = [line[2:] for line in lines if line.startswith(">")]
            shown = [line[2:] for line in lines if line.startswith("<")]
            spoken = subprocess.run([sys.executable, ADAPTER / "adapter.py"],
                                    input="\n".join(given + ["bye"]) + "\n", check=True,
                                    capture_output=True, text=True).stdout
            self.assertEqual(shown, spoken.splitlines())

    def test_failure(self):
        shown = [without_times(text) for text in blocks("") if text.startswith("$ rubric test")]
        self.assertEqual([without_times(failure())], shown, RENEW)

    def test_known_failures(self):
        known = [block for block in blocks("yaml") if block.startswith("- case")]
        self.assertEqual(len(known), 1)
        names = [line.split()[0] for line in rubric("test", "--list").stdout.splitlines()]
        for entry in yaml.safe_load(known[0]):
            for glob in [entry["case"]] if "case" in entry else entry["skip"]:
                self.assertTrue(fnmatch.filter(names, glob), glob)
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write(known[0])
            file.flush()
            tried = rubric("test", "--list", "--expect", file.name)
        self.assertEqual((tried.returncode, tried.stderr), (0, ""))

    def test_recipes(self):
        recipes = [yaml.safe_load(block) for block in blocks("yaml") if "- case" not in block]
        self.assertEqual(len(recipes), 2)
        github, gitlab = recipes
        runs = [step["run"] for step in github["jobs"]["rubric"]["steps"] if "run" in step]
        scripts = runs + gitlab["conformance"]["script"]
        options = set(re.findall(r" (--[a-z]+)", " ".join(s for s in scripts if " test " in s)))
        self.assertLessEqual({"--target", "--expect", "--report"}, options)
        described = rubric("test", "--help").stdout
        for option in options:
            self.assertIn(option, described)

    def test_links(self):
        for target in re.findall(r"\]\(([^)#]+)\)", TEXT):
            self.assertTrue((ROOT / "conformance" / target).exists(), target)


def without_times(text):
    """Wall-clock times differ from run to run."""
    return re.sub(r"\d+(\.\d+)? (ms|s)\b", "TIME", text)


if __name__ == "__main__":
    if sys.argv[1:] == ["--regenerate"]:
        regenerate()
    else:
        unittest.main(argv=sys.argv[:1])
