#!/usr/bin/env python3
"""Compares README.md's table with the targets: each is there, with the property that it states.

Usage: fuzz/readme_test.py [--write]; --write puts the table right.
"""

import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "support"))
import targets as fuzz  # pylint: disable=wrong-import-position

README = fuzz.ROOT / "fuzz/README.md"
TABLE = re.compile(r"^\| target \| property \|\n\|---\|---\|\n((?:\|.*\n)*)", re.M)


def main():
    sources = fuzz.sources()
    listed = (fuzz.ROOT / "fuzz/CMakeLists.txt").read_text(encoding="utf-8")
    names = {f.name[:-len("_fuzz.cc")] for f in sources}
    apart = names ^ set(re.findall(r"^rubric_fuzzer\((\w+)", listed, re.M))
    rows = "".join(f"| `{f.name[:-len('_fuzz.cc')]}` | {fuzz.property_of(f)} |\n" for f in sources)
    text = README.read_text(encoding="utf-8")
    table = TABLE.search(text)
    if sys.argv[1:] == ["--write"]:
        README.write_text(text[:table.start(1)] + rows + text[table.end(1):], encoding="utf-8")
        return 0
    if apart:
        print(f"in fuzz/CMakeLists.txt or in fuzz/targets, not in both: {' '.join(sorted(apart))}")
    if not rows or table[1] != rows:
        print("fuzz/README.md: its table is not what the targets say: fuzz/readme_test.py --write")
    return 1 if apart or table[1] != rows or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
