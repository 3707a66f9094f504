#!/usr/bin/env python3
"""An implementation that ships passes every case that its roles can play, and skips only others.

Usage: suite_test.py [--page FILE] [--without PARAMETER ...] RUBRIC TARGET [option of rubric test]
With --page the counts that are printed have to be in that file. With --without=PARAMETER it skips
the cases for nodes that are built with such a parameter, too.
"""

import argparse
import json
import pathlib
import subprocess
import sys


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--without", action="append", default=[])
    parser.add_argument("rubric")
    parser.add_argument("target")
    asked, options = parser.parse_known_args()
    tested = subprocess.run(
        [asked.rubric, "test", "--target", asked.target, "--format", "json", *options],
        capture_output=True, text=True)
    if not tested.stdout:
        print(tested.stderr)
        return 1
    run = json.loads(tested.stdout)["implementations"][0]
    wrong = passed = others = left_out = 0
    for case in run["cases"]:
        plays = set(case["roles"]) <= set(run["roles"])
        unbuilt = any(case["reason"].startswith(f"it is not built with {parameter}=")
                      for parameter in asked.without)
        wanted = "pass" if plays and not unbuilt else "skip"
        passed += case["verdict"] == "pass"
        others += not plays
        left_out += plays and unbuilt
        if case["verdict"] == wanted:
            continue
        wrong += 1
        print(f"{case['name']}: {case['verdict']}, not {wanted}. {case['reason']}")
        for failure in case["failures"]:
            print("  ", " ".join(failure["requirements"]), failure["expected"], failure["text"])
    counts = (f"{passed} of {len(run['cases'])} cases pass, "
              f"{others} need a role that it does not play")
    if left_out:
        counts += f", {left_out} a node that is built otherwise"
    print(f"{run['name']} {run['version']}: {counts}; {wrong} do otherwise, "
          f"{run['wall_ms']:.0f} ms {run['dishonest']}")
    if asked.page and counts not in " ".join(asked.page.read_text(encoding="utf-8").split()):
        print(f"{asked.page} does not say: {counts}")
        wrong += 1
    return 1 if wrong or not passed or tested.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
