#!/usr/bin/env python3
"""Runs every `$ ...` line of README.md and compares what it prints.

Usage: readme_test.py PATH_TO_RUBRIC [--write]
"""

import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools/book"))

import snippets  # pylint: disable=wrong-import-position


def main():
    readme = ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="rubric-readme-") as folder:
        place = snippets.Place(folder, ROOT, pathlib.Path(sys.argv[1]).resolve().parent)
        now, wrong = snippets.renewed(text, place)
    if sys.argv[2:] == ["--write"]:
        readme.write_text(now, encoding="utf-8")
    for line, what in wrong:
        print(f"README.md:{line}: {what}")
    shown = sum(block.language == "console" for block in snippets.blocks(text))
    print(f"{shown} blocks of commands, {len(wrong)} mistakes")
    return 1 if wrong or not shown else 0


if __name__ == "__main__":
    sys.exit(main())
