#!/usr/bin/env python3
"""Each mutant that the tool makes of a small program behaves as its new line says.

Usage: tool_test.py C++-COMPILER

For each mutant of sample.cc and sample.py the program with all mutants, told to be that one, prints
what a copy prints in which the mutant's line is replaced.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

import generate
from subjects import Subject

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = "conformance/selftest/source_mutants"
TIMEOUT_S = 10
# Mutants that must be there, by language: what lines become.
WANTED = {
    "sample.cc": [
        "bool is_inside(int x) { return x >= 2 && x <= kMost; }",
        "bool is_inside(int x) { return x > 2 || x <= kMost; }",
        "bool is_inside(int x) { return x <= kMost; }",
        "bool is_inside(int x) { return x > 2 && x <= (kMost + 1); }",
        "bool is_inside(int x) { return x > (2 - 1) && x <= kMost; }",
        "int less(int a, int b) { return a * 10 + b; }",
        "if (true) continue;",
        "if (false) continue;",
        "*sum -= i;",
        ";",
        'std::printf(" %d %d\\n", sum, sample::less(4, 3));',
    ],
    "sample.py": [
        "return x >= 2 and x <= MOST",
        "return (x > 2) or (x <= MOST)",
        "return (x <= MOST)",
        "return x > 2 and x <= (MOST + 1)",
        "return (a * 10) + (b)",
        "if True:",
        "if False:",
        "pass",
    ],
}


def output(command, mutant=0):
    """What a program prints, and how it ends."""
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S,
                             env=dict(os.environ, RUBRIC_SOURCE_MUTANT=str(mutant)))
    except subprocess.TimeoutExpired:
        return "hangs"
    return run.stdout if run.returncode == 0 else "fails"


class Language:
    def __init__(self, name, compiler, scratch):
        self.name, self.compiler, self.scratch = name, compiler, scratch

    def program(self, source, *others):
        """The command that runs it, None if it does not compile."""
        if self.name.endswith(".py"):
            return ["python3", source]
        program = self.scratch / "program"
        built = subprocess.run([self.compiler, "-std=c++20", "-w", source, *others, "-o", program],
                               capture_output=True)
        return [program] if built.returncode == 0 else None


def replaced(lines, mutant):
    """The text in which the mutant's line is its new one."""
    at = mutant["line"] - 1
    indent = lines[at][:len(lines[at]) - len(lines[at].lstrip())]
    return "\n".join([*lines[:at], indent + mutant["new"], *lines[at + 1:]]) + "\n"


def check(name, compiler, scratch):
    """Returns how many mutants there are and what is wrong."""
    language = Language(name, compiler, scratch)
    subject = Subject(FOLDER, (name,), language="python" if name.endswith(".py") else "c++")
    generate.generate(subject, HERE.parents[2], scratch)
    mutants = json.loads((scratch / "mutants.json").read_text(encoding="utf-8"))
    news = [mutant["new"] for mutant in mutants]
    wrong = [f"{name}: no mutant {new}" for new in WANTED[name] if new not in news]
    lines = (HERE / name).read_text(encoding="utf-8").splitlines()
    others = [HERE / "switch.cc"] if name.endswith(".cc") else []
    together = language.program(scratch / FOLDER / name, *others)
    if not together:
        return 0, [f"{name}: the copy with all mutants does not compile"]
    if name.endswith(".cc"):
        together = [together[0].rename(scratch / "together")]
    alone = scratch / ("alone" + pathlib.Path(name).suffix)
    alone.write_text("\n".join(lines) + "\n", encoding="utf-8")
    honest = output(language.program(alone))
    if output(together) != honest:
        wrong.append(f"{name}: without a mutant it prints something else")
    for mutant in mutants:
        alone.write_text(replaced(lines, mutant), encoding="utf-8")
        expected = output(language.program(alone))
        found = output(together, mutant["number"])
        if found != expected:
            wrong.append(f"{name}:{mutant['line']}: {mutant['new']}: {found}, not {expected}")
    return len(mutants), wrong


def main():
    failed = False
    for name in WANTED:
        with tempfile.TemporaryDirectory() as scratch:
            count, wrong = check(name, sys.argv[1], pathlib.Path(scratch))
        failed |= bool(wrong) or count == 0
        print(f"{name}: {count} mutants, {len(wrong)} wrong", *wrong, sep="\n  ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
