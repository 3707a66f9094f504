#!/usr/bin/env python3
"""Write copies of an implementation's sources that contain all its mutants behind a switch.

Usage: generate.py SUBJECT PROJECT OUT
       generate.py --list SUBJECT PROJECT

SUBJECT is one of those in subjects.py. The copies go to the same places below OUT, and
OUT/mutants.json lists the mutants: number, file, line, function, old and new lines. --list prints
the sources' names.
"""

import dataclasses
import json
import pathlib
import sys

import cxx
import python
import sites
from subjects import SUBJECTS


def generate(subject, project, out):
    texts = {file: (project / file).read_text(encoding="utf-8") for file in subject.paths(project)}
    language = python if subject.language == "python" else cxx
    by_file = language.mutants(subject, project, texts)
    number = 0
    listed = []
    for file, text in texts.items():
        mutants = by_file.get(file, []) if pathlib.Path(file).name not in subject.as_it_is else []
        for mutant in mutants:
            number += 1
            mutant.number = number
        sites.describe(mutants, text)
        copy = out / file
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(language.finish(sites.render(text, mutants, language.wrap)),
                        encoding="utf-8")
        for mutant in mutants:
            listed.append({key: value for key, value in dataclasses.asdict(mutant).items()
                           if key != "edits"})
    (out / "mutants.json").write_text(json.dumps(listed, indent=0), encoding="utf-8")


def main():
    name, project, out = sys.argv[1:]
    if name == "--list":
        print("\n".join(SUBJECTS[project].paths(pathlib.Path(out))))
        return
    generate(SUBJECTS[name], pathlib.Path(project).resolve(), pathlib.Path(out))


if __name__ == "__main__":
    main()
