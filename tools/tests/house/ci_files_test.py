#!/usr/bin/env python3
"""The files for continuous integration: parsed, linted, and their scripts run as a runner would.

Usage: ci_files_test.py RUBRIC; run in the project's folder.
"""

import os
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

import yaml

import testing
from testing import RUBRIC

FOLDER = pathlib.Path("conformance/ci")
CAPTURE = pathlib.Path("spec/captures/firmware/a_join_data.pcapng").resolve()
ANSWERS = "--target machine --cases 'j4.*'"


class CiFiles(testing.Folder):
    def run_script(self, script, **variables):
        """Runs a script as a runner's shell does: bash, stopping at the first error."""
        path = f"{os.path.dirname(RUBRIC)}:{os.environ['PATH']}"
        syntax = subprocess.run(["bash", "-n", "-c", script], capture_output=True, check=False)
        self.assertEqual((syntax.returncode, syntax.stderr), (0, b""))
        return subprocess.run(["bash", "-eo", "pipefail", "-c", script], cwd=self.folder,
                              env={"PATH": path, **variables}, capture_output=True, text=True,
                              check=False)

    def verdicts(self, file):
        return ElementTree.parse(self.folder / file).getroot()

    def test_the_action(self):
        action = yaml.safe_load((FOLDER / "action.yml").read_text(encoding="utf-8"))
        self.assertEqual(action["runs"]["using"], "composite")
        step = action["runs"]["steps"][0]
        given = {name: re.fullmatch(r"\$\{\{ inputs\.(\w+) \}\}", value).group(1)
                 for name, value in step["env"].items()}
        self.assertEqual(set(given.values()), set(action["inputs"]))
        used = set(re.findall(r"\$\{?([A-Z_]+)", step["run"])) - {"GITHUB_OUTPUT",
                                                                 "GITHUB_STEP_SUMMARY"}
        self.assertEqual(used, set(given))
        for command, arguments, wanted in (("test", ANSWERS, 0), ("check", str(CAPTURE), None),
                                           ("test", "--target ./nowhere", 2),
                                           ("test", "--no-such", 64)):
            variables = {"COMMAND": command, "ARGUMENTS": arguments, "EXPECT": "",
                         "RESULTS": "results", "GITHUB_OUTPUT": str(self.folder / "output"),
                         "GITHUB_STEP_SUMMARY": str(self.folder / "summary")}
            done = self.run_script(step["run"], **variables)
            if wanted is None:
                wanted = subprocess.run([RUBRIC, command, arguments], capture_output=True,
                                        check=False).returncode
            self.assertEqual(done.returncode, wanted, done.stderr)
            output = (self.folder / "output").read_text(encoding="utf-8").splitlines()
            self.assertEqual(output[-1], f"code={wanted}")
            if wanted in (0, 1):
                self.assertIn("test", self.verdicts(f"results/{command}.xml").tag)

    def test_the_templates(self):
        file = yaml.safe_load((FOLDER / "rubric.gitlab-ci.yml").read_text(encoding="utf-8"))
        base = file[".rubric"]
        self.assertEqual(base["artifacts"]["reports"]["junit"], "rubric.xml")
        for name, arguments in ((".rubric-test", ANSWERS), (".rubric-check", str(CAPTURE))):
            self.assertEqual(file[name]["extends"], ".rubric")
            variables = {**base["variables"], **file[name]["variables"],
                         "RUBRIC_ARGUMENTS": arguments}
            done = self.run_script("\n".join(base["script"]), **variables)
            self.assertIn(done.returncode, (0, 1), done.stderr)
            self.assertIn("test", self.verdicts("rubric.xml").tag)
        done = self.run_script("\n".join(base["script"]), RUBRIC_COMMAND="test",
                               RUBRIC_ARGUMENTS="--target ./nowhere")
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
