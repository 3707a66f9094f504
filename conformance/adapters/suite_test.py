#!/usr/bin/env python3
"""An implementation that ships passes every case that its roles can play, and skips only others,
and those for which it would have to be built otherwise.

Usage: suite_test.py RUBRIC TARGET [option of rubric test ...]
"""

import json
import subprocess
import sys


def main():
    rubric, target, *options = sys.argv[1:]
    tested = subprocess.run([rubric, "test", "--target", target, "--format", "json", *options],
                            capture_output=True, text=True)
    if not tested.stdout:
        print(tested.stderr)
        return 1
    run = json.loads(tested.stdout)["implementations"][0]
    wrong = passed = 0
    for case in run["cases"]:
        wanted = "pass" if set(case["roles"]) <= set(run["roles"]) else "skip"
        passed += case["verdict"] == "pass"
        unbuilt = case["verdict"] == "skip" and case["reason"].startswith("it is not built with")
        if case["verdict"] == wanted or unbuilt:
            continue
        wrong += 1
        print(f"{case['name']}: {case['verdict']}, not {wanted}. {case['reason']}")
        for failure in case["failures"]:
            print("  ", " ".join(failure["requirements"]), failure["expected"], failure["text"])
    print(f"{run['name']} {run['version']}: {passed} cases pass, {wrong} do otherwise, "
          f"{run['wall_ms']:.0f} ms {run['dishonest']}")
    return 1 if wrong or not passed or tested.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
