#!/usr/bin/env python3
"""What CONTRIBUTING.md names is there: files, targets, presets, tests, labels and options.

Usage: contributing_test.py RUBRIC
"""

import json
import os
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools/book"))

import snippets  # pylint: disable=wrong-import-position

VERB = re.compile(r"^\s*(rubric_(?:library|program|(?:(?:command|script)_)?test|benchmark|fuzzer)"
                  r"|add_custom_target)\((\w+)", re.M)
LABELS = {"fast", "slow", "long", "foreign"}  # rubric_label_test() sets them.


def targets():
    """The names of all targets and tests that the project's own CMake files make."""
    files = [path for folder in snippets.FOLDERS for pattern in ("CMakeLists.txt", "*.cmake")
             for path in (ROOT / folder).rglob(pattern)]
    texts = [path.read_text(encoding="utf-8") for path in files]
    return {name for text in texts for _, name in VERB.findall(text)}


def command_mistakes(line, known, presets):
    """Of a line of a shell: words that lead nowhere."""
    command = line.split(" #")[0]
    named = [("preset", r"--preset (\S+)", presets), ("target", r"--build .*--target (\w+)", known),
             ("test", r"(?:ctest.*) -R (\S+)", known), ("label", r"(?:ctest.*) -L (\w+)", LABELS)]
    for what, pattern, names in named:
        yield from (f"no {what} {name}" for name in re.findall(pattern, command)
                    if name not in names)
    for word in re.findall(r"(?<!\S)[\w.-]+/[\w./-]*", command):
        program = command.startswith(word)
        if not word.startswith("build/") and not (ROOT / word).exists():
            yield f"no file {word}"
        elif program and not os.access(ROOT / word, os.X_OK):
            yield f"{word} is not a program"


def name_mistakes(name, known):
    """Of inline code that is one word: a path of the project, or a name with a test's ending."""
    if "/" in name and "$" not in name and "NAME" not in name:
        if not name.startswith("build/") and not (ROOT / name).exists():
            yield f"no file {name}"
    elif name.endswith("_test") and not name.startswith("rubric_") and name not in known:
        yield f"no test {name}"


def mistakes(text, place):
    known = targets()
    presets = {preset["name"] for preset in
               json.loads((ROOT / "CMakePresets.json").read_text("utf-8"))["configurePresets"]}
    prose = snippets.FENCED.sub("", text)
    code = " ".join(prose.split())
    inline = re.findall(r"`([^`]+)`", code)
    commands = [line for block in snippets.blocks(text) for line in block.text.splitlines()]
    for line in commands + [words for words in inline if " " in words]:
        yield from command_mistakes(line, known, presets)
        try:
            place.options(line.split(" #")[0])
        except snippets.Wrong as wrong:
            yield str(wrong)
    for name in inline:
        if " " not in name:
            yield from name_mistakes(name, known)
    for name in re.findall(r"targets? `(\w+)`|[Bb]uild `(\w+)`", code):
        if "".join(name) not in known | presets:
            yield f"no target {''.join(name)}"


def main():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="rubric-contributing-") as folder:
        place = snippets.Place(folder, ROOT, pathlib.Path(sys.argv[1]).resolve().parent)
        found = list(mistakes(text, place))
        for line in ("ctest --preset dev -R unicorn_test", "ctest --preset horn -L fast",
                     "cmake --build --preset dev --target unicorn", "tools/unicorn",
                     "rubric coverage --unicorn", "rubric unicorn", "ctest --preset dev -L horn"):
            planted = f"{text}\n```sh\n{line}\n```\n"
            assert len(list(mistakes(planted, place))) == len(found) + 1, line
        for words in ("`spec/unicorn`", "`unicorn_test`", "the target `unicorn`"):
            assert len(list(mistakes(f"{text}\n{words}\n", place))) == len(found) + 1, words
    for mistake in found:
        print(f"CONTRIBUTING.md: {mistake}")
    print(f"{len(found)} mistakes")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
