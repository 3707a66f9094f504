#!/usr/bin/env python3
"""Runs every `$ build/release/rubric ...` shown in README.md and compares what it prints.

Usage: readme_test.py PATH_TO_RUBRIC, in the project's folder.
"""

import re
import shlex
import subprocess
import sys

PROGRAM = "build/release/rubric"
BLOCK = re.compile(r"^```\n\$ (" + PROGRAM + r"[^\n]*)\n(.*?)^```$", re.M | re.S)


def main():
    with open("README.md", encoding="utf-8") as file:
        blocks = BLOCK.findall(file.read())
    failed = 0
    for command, shown in blocks:
        words = [sys.argv[1]] + shlex.split(command)[1:]
        printed = subprocess.run(words, capture_output=True, text=True, check=False).stdout
        if printed != shown:
            failed += 1
            print(f"README.md shows for\n$ {command}\n{shown}\nbut it prints\n{printed}")
    print(f"{len(blocks) - failed} of {len(blocks)} commands print what README.md shows")
    return 1 if failed or not blocks else 0


if __name__ == "__main__":
    sys.exit(main())
