#!/usr/bin/env python3
"""Mistakes put into an implementation are found by `rubric test`, by the rule that they break.

Usage: seeded_bugs_test.py --bugs BUGS.json --rubric RUBRIC --target COMMAND [--build COMMAND]
                           [--tree FOLDER] [-- option of rubric test ...]

BUGS.json is a list of {"name", "file", "old", "new", "requirement"}: `old`, which occurs exactly
once in `file`, is replaced by `new`, and then a case has to fail at a line that names
`requirement`. Where only SHOULD rules are broken an entry says "verdict": "weak" as well: then a
case has to be weak there, none may fail, and the run ends with 0. `file` is relative to FOLDER, the
implementation's tree: the folder of BUGS.json if not given. Each bug gets a copy of the tree of its
own; {dir} in the commands stands for it, and they run there. First the copy is tried without a bug:
it has to pass.
"""

import argparse
import json
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

KEYS = {"name", "file", "old", "new", "requirement"}
CODE_OF = {"fail": 1, "weak": 0}    # How rubric test ends, by the worst verdict.
TIMEOUT_S = 600


class Mistake(Exception):
    """In the list of bugs, not in what it is tried on."""


def read_bugs(path):
    bugs = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(bugs, list) or not bugs:
        raise Mistake(f"{path}: not a list of bugs")
    for number, bug in enumerate(bugs, 1):
        if not isinstance(bug, dict) or set(bug) - {"verdict"} != KEYS:
            raise Mistake(f"{path}: bug {number} has not just {', '.join(sorted(KEYS))}")
        if bug.setdefault("verdict", "fail") not in CODE_OF:
            raise Mistake(f"{path}: bug {number} is neither fail nor weak")
    names = [bug["name"] for bug in bugs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise Mistake(f"{path}: more than one bug is called {', '.join(twice)}")
    return bugs


def plant(bug, tree):
    path = tree / bug["file"]
    if not path.is_file():
        raise Mistake(f"{bug['name']}: there is no {bug['file']}")
    text = path.read_text(encoding="utf-8")
    found = text.count(bug["old"])
    if found != 1:
        raise Mistake(f"{bug['name']}: in {bug['file']} the old text occurs {found} times, "
                      "not once")
    if bug["new"] == bug["old"]:
        raise Mistake(f"{bug['name']}: changes nothing")
    path.write_text(text.replace(bug["old"], bug["new"]), encoding="utf-8")


class Bench:
    def __init__(self, options):
        self.options = options
        self.tree = pathlib.Path(options.tree or options.bugs.parent).resolve()

    def run(self, command, folder):
        return subprocess.run(command, cwd=folder, capture_output=True, text=True,
                              timeout=TIMEOUT_S)

    def try_copy(self, bug):
        """The report of rubric test on a copy of the tree, with the bug if there is one."""
        with tempfile.TemporaryDirectory() as scratch:
            copy = pathlib.Path(scratch) / "copy"
            shutil.copytree(self.tree, copy, symlinks=True,
                            ignore=shutil.ignore_patterns("__pycache__"))
            if bug:
                plant(bug, copy)
            named = {"dir": shlex.quote(str(copy))}
            if self.options.build:
                built = self.run(["sh", "-c", self.options.build.format(**named)], copy)
                if built.returncode != 0:
                    raise Mistake(f"it does not build:\n{built.stdout}{built.stderr}")
            report = pathlib.Path(scratch) / "report.json"
            tested = self.run([self.options.rubric, "test", "--target",
                               self.options.target.format(**named), "--format", "json",
                               "--out", str(report), *self.options.rest], copy)
            if not report.is_file():
                raise Mistake(f"rubric test wrote no report:\n{tested.stdout}{tested.stderr}")
            return tested.returncode, json.loads(report.read_text(encoding="utf-8"))


def cases_of(report):
    return [case for run in report["implementations"] for case in run["cases"]]


def broken_rules(report, verdicts=("fail", "weak")):
    """The rules that failed lines name, with the cases."""
    rules = {}
    for case in cases_of(report):
        for failure in case["failures"] if case["verdict"] in verdicts else []:
            for rule in failure["requirements"] + failure["suspected"]:
                rules.setdefault(rule, {})[case["name"]] = True
    return rules


def judge(bug, code, report):
    """Returns what is wrong with how the bug was found; empty if nothing is."""
    rules = broken_rules(report)
    verdicts = sorted({case["verdict"] for case in cases_of(report)})
    wanted = CODE_OF[bug["verdict"]]
    if code != wanted:
        return f"rubric test ended with {code}, not with {wanted}; verdicts: {', '.join(verdicts)}"
    if bug["verdict"] == "weak":
        rules = broken_rules(report, ("weak",))
        if not {"fail", "error"}.isdisjoint(verdicts):
            return f"not just weak; verdicts: {', '.join(verdicts)}"
    if bug["requirement"] not in rules:
        others = ", ".join(sorted(rules)) or "nothing"
        return f"not found by {bug['requirement']}, but by {others}"
    return ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bugs", type=pathlib.Path, required=True)
    parser.add_argument("--rubric", required=True)
    parser.add_argument("--target", required=True)
    parser.add_argument("--build", default="")
    parser.add_argument("--tree")
    parser.add_argument("rest", nargs="*")
    options = parser.parse_args()
    options.rubric = str(pathlib.Path(options.rubric).resolve())
    bench = Bench(options)
    wrong = 0
    try:
        bugs = read_bugs(options.bugs)
        code, report = bench.try_copy(None)
        passed = sum(case["verdict"] == "pass" for case in cases_of(report))
        if code != 0 or passed == 0:
            raise Mistake(f"without a bug rubric test ended with {code}, {passed} cases passed")
        print(f"without a bug: {passed} cases pass")
        for bug in bugs:
            code, report = bench.try_copy(bug)
            complaint = judge(bug, code, report)
            wrong += bool(complaint)
            by = ", ".join(list(broken_rules(report).get(bug["requirement"], {}))[:3])
            print(f"{bug['name']}: {complaint or bug['requirement'] + ' in ' + by}", flush=True)
    except (Mistake, OSError, ValueError) as mistake:
        print(f"seeded_bugs_test.py: {mistake}", file=sys.stderr)
        return 2
    print(f"{len(bugs)} bugs, {wrong} not found")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
