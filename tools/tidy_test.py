#!/usr/bin/env python3
"""Keeps the house rules that a compiler does not: who may include whom, line lengths, file sizes.

Usage: tidy_test.py PROJECT_FOLDER. Prints each breach with its place; exit 1 if there is one.
"""

import pathlib
import re
import subprocess
import sys

# A folder and the project's folders whose headers its files may include. Tests may include more.
ALLOWED = {
    "spec/compiler": ["spec/compiler", "codec/runtime"],
    "codec/runtime": ["codec/runtime"],
    "codec/generated": ["codec/runtime", "codec/generated", "codec/reflect/schema.h"],
    "codec/containers": ["codec/runtime", "codec/containers"],
    "codec/reflect": ["codec/runtime", "codec/generated", "codec/containers", "codec/reflect",
                      "codec/codec_test"],
    "codec/generate": ["codec"],
    "conformance/machine": ["codec/runtime", "codec/generated", "conformance/machine",
                            "conformance/generated/profiles.h"],
    "conformance/trace": ["codec", "conformance/trace"],
    # Legal traffic is written from the rules: it shares nothing with what it is a test of.
    "conformance/legal": ["codec", "conformance/legal"],
    # Written from the rules as well, and tried by what the reference machine passes.
    "conformance/adapters/cpp": ["codec/runtime", "codec/generated", "conformance/adapters/cpp"],
    "conformance/adapters/firmware": ["codec/runtime", "codec/generated",
                                      "conformance/adapters/firmware"],
    "conformance": ["codec", "conformance"],
    "fuzz": ["codec", "conformance", "spec/compiler", "fuzz", "tools"],
    # Skeletons leave the project, so they need nothing of it.
    "tools/skeletons": ["my_node.h"],
    "tools": ["codec", "conformance", "tools"],
}
CODE = {".cc", ".h", ".py", ".js", ".java", ".nc", ".c", ".pml", ".cmake"}
SOURCES = CODE | {".ksy", ".md", ".sh", ".yaml"}
MAX_COLUMNS = 100
MAX_LINES = 600
INCLUDE = re.compile(r'#include "([^"]+)"')
# A quotation of a rule beside the code that keeps it: `//= J4-SEQ: the sentence`, perhaps going on
# in the next `//=` line.
QUOTE = re.compile(r"\s*//= (.*)")
# Code names a rule.
NAMED_RULE = re.compile(r'"([\w-]+)"_rule')
QUOTE_START = re.compile(r"([A-Z][A-Z0-9-]*[A-Z0-9]): (.*)")


def catalogue(root):
    """The sentence of each rule."""
    text = (root / "spec/requirements.yaml").read_text(encoding="utf-8")
    pairs = re.findall(r'^- id: (\S+)\n(?:  .*\n)*?  sentence: "(.*)"$', text, re.M)
    return dict(pairs)


def quotes(lines):
    """Each quotation with the number of its first line."""
    found = []
    going_on = False
    for number, line in enumerate(lines, 1):
        quote = QUOTE.match(line)
        start = quote and QUOTE_START.match(quote[1])
        if start:
            found.append([number, start[1], start[2]])
        elif quote and going_on:
            found[-1][2] += " " + quote[1]
        elif quote:
            found.append([number, quote[1], ""])
        going_on = quote is not None
    return found


def quote_breaches(path, lines, sentences):
    for number, rule, text in quotes(lines):
        if rule not in sentences:
            yield f"{path}:{number}: the catalogue has no rule {rule}"
        elif text != sentences[rule]:
            yield f"{path}:{number}: {rule} says: {sentences[rule]}"


def name_breaches(path, lines, sentences):
    """Names of rules that the catalogue does not have; their numbers would be nobody's."""
    for number, line in enumerate(lines, 1):
        for name in NAMED_RULE.findall(line):
            if name not in sentences:
                yield f"{path}:{number}: the catalogue has no rule {name}"


def tracked(root):
    out = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, check=True,
                         capture_output=True, text=True).stdout
    return [pathlib.PurePath(line) for line in out.splitlines() if (root / line).is_file()]


def include_breaches(path, lines):
    area = next((a for a in ALLOWED if str(path).startswith(a + "/")), None)
    if area is None or path.stem.endswith(("_test", "_bench")) or "_test/" in str(path) \
            or "_bench/" in str(path):
        return
    for number, line in enumerate(lines, 1):
        found = INCLUDE.match(line)
        if found and not any(found[1] == a or found[1].startswith(a + "/") for a in ALLOWED[area]):
            yield f"{path}:{number}: {area} may not include {found[1]}"


def breaches(root, path, sentences):
    generated = "generated" in path.parts or "captures" in path.parts or "vectors" in path.parts
    code = path.suffix in CODE or path.name == "CMakeLists.txt"
    if not code and path.suffix not in SOURCES:
        return
    lines = (root / path).read_text(encoding="utf-8").splitlines()
    yield from include_breaches(path, lines)
    quoting = path.suffix in {".cc", ".h", ".java"}
    yield from quote_breaches(path, lines if quoting else [], sentences)
    yield from name_breaches(path, lines if quoting else [], sentences)
    for number, line in enumerate(lines, 1):
        # Prose in data files and tables in documents may run long.
        if code and not (generated and path.suffix != ".h") and len(line) > MAX_COLUMNS:
            yield f"{path}:{number}: {len(line)} columns, at most {MAX_COLUMNS}"
        if code and line != line.rstrip():
            yield f"{path}:{number}: blanks at the end of the line"
    if code and not generated and len(lines) > MAX_LINES:
        yield f"{path}: {len(lines)} lines, at most {MAX_LINES}"
    if path.suffix == ".h" and "#pragma once" not in lines:
        yield f"{path}: no #pragma once"


def main():
    root = pathlib.Path(sys.argv[1])
    files = tracked(root)
    sentences = catalogue(root)
    found = [b for path in files for b in breaches(root, path, sentences)]
    for breach in found:
        print(breach)
    print(f"{len(files)} files, {len(found)} breaches")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
