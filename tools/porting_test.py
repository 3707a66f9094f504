#!/usr/bin/env python3
"""What conformance/PORTING.md shows is what happens: the loop, the conversations, the failure.

Usage: porting_test.py RUBRIC PROJECT_FOLDER
"""

import fnmatch
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

RUBRIC = str(pathlib.Path(sys.argv[1]).resolve())
ROOT = pathlib.Path(sys.argv[2]).resolve()
TEXT = (ROOT / "conformance/PORTING.md").read_text(encoding="utf-8")
ADAPTER = ROOT / "conformance/adapters/python"


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.M | re.S)


def rubric(*words, folder=ROOT):
    plain = {key: value for key, value in os.environ.items() if key != "GITHUB_ACTIONS"}
    return subprocess.run([RUBRIC, *words], cwd=folder, capture_output=True, text=True, env=plain)


class Porting(unittest.TestCase):
    def test_loop_is_that_of_the_adapter(self):
        loops = blocks("python")
        self.assertEqual(len(loops), 1)
        self.assertIn("def answer", loops[0])
        self.assertIn(loops[0], (ADAPTER / "adapter.py").read_text(encoding="utf-8"))

    def test_conversations(self):
        conversations = re.findall(r"(?:^    [<>] .*\n)+", TEXT, re.M)
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
        shown = [block for block in blocks("") if block.startswith("$ rubric test")]
        self.assertEqual(len(shown), 1)
        command, expected = shown[0].split("\n", 1)
        bugs = json.loads((ADAPTER / "bugs.json").read_text(encoding="utf-8"))
        bug = next(bug for bug in bugs if bug["requirement"] == "J4-SEQ")
        with tempfile.TemporaryDirectory() as folder:
            for name in ("adapter.py", "mote.py"):
                shutil.copy(ADAPTER / name, folder)
            mote = pathlib.Path(folder) / bug["file"]
            mote.write_text(mote.read_text().replace(bug["old"], bug["new"]))
            words = ["test", "--target", "python3 adapter.py", "--requirement", "J4-SEQ", "--quiet"]
            self.assertEqual(command, "$ rubric test --target 'python3 adapter.py' "
                             "--requirement J4-SEQ --quiet")
            tried = rubric(*words, folder=folder)
        self.assertEqual(tried.returncode, 1)
        self.assertEqual(without_times(expected), without_times(tried.stdout))

    def test_known_failures(self):
        known = [block for block in blocks("yaml") if block.startswith("- case")]
        self.assertEqual(len(known), 1)
        names = [line.split()[0] for line in rubric("test", "--list").stdout.splitlines()]
        for entry in yaml.safe_load(known[0]):
            self.assertTrue(fnmatch.filter(names, entry["case"]), entry["case"])
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
    unittest.main(argv=sys.argv[:1])
