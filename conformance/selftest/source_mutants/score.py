#!/usr/bin/env python3
"""Run the golden traces on an implementation's mutants, and print survivors and a score a file.

Usage: score.py [--every N] [--file NAME] [--jobs N] [--cases FOLDER] SUBJECT MUTANTS RUN TARGET

MUTANTS is the list that generate.py wrote, RUN the program source_mutants_run, TARGET what that
takes. survivors/SUBJECT.yaml lists the mutants that no trace finds, with reasons; `open` are those
without one. If others survive, or one of those does not, the exit code is 1. --every 10 tries each
tenth mutant only. --renew takes those that are found, or are no mutants any more, off the list, and
adds the others as open.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

import yaml

HERE = pathlib.Path(__file__).resolve().parent
KINDS = ("equivalent", "free", "open")


def key_of(mutant):
    nth = f" #{mutant['nth']}" if mutant["nth"] > 1 else ""
    return pathlib.Path(mutant["file"]).name, mutant["function"] + nth, mutant["old"], mutant["new"]


def read_survivors(path):
    """Key of a mutant: its entry."""
    out = {}
    for entry in yaml.safe_load(path.read_text(encoding="utf-8")):
        if set(entry) - {"decision"} != {"kind", "reason", "mutants"}:
            raise ValueError(f"an entry has not just kind, reason and mutants: {entry}")
        if entry["kind"] not in KINDS:
            raise ValueError(f"{entry['kind']} is none of {', '.join(KINDS)}")
        if entry["kind"] == "free" and "decision" not in entry:
            raise ValueError(f"which decision or rule makes it free? {entry['reason']}")
        for file, function, old, *new in entry["mutants"]:
            for one in new:
                if (file, function, old, one) in out:
                    raise ValueError(f"listed twice: {file}, {function}: {one}")
                out[file, function, old, one] = entry
    return out


def write_survivors(path, found):
    """found: key of a mutant and its entry, None if nobody has judged it."""
    entries = {}
    for key, entry in found:
        entry = entry or {"kind": "open", "reason": "Nobody has judged it yet."}
        head = {name: entry[name] for name in ("kind", "decision", "reason") if name in entry}
        lines = entries.setdefault(json.dumps(head), {})
        lines.setdefault(key[:3], []).append(key[3])
    comment = next(iter(path.read_text(encoding="utf-8").splitlines()), "")
    with path.open("w", encoding="utf-8") as out:
        print(comment if comment.startswith("#") else "# See ../README.md.", file=out)
        for head in sorted(entries, key=lambda head: '"open"' in head):
            first = "- "
            for name, value in json.loads(head).items():
                text = json.dumps(value) if name == "reason" else value
                print(f"{first}{name}: {text}", file=out)
                first = "  "
            print("  mutants:", file=out)
            for line, news in entries[head].items():
                print(f"  - {json.dumps([*line, *dict.fromkeys(news)])}", file=out)


def run_part(command, part):
    out = subprocess.run(["nice", "-n", "15", *command, *map(str, part)], capture_output=True,
                         text=True)
    if out.returncode != 0:
        raise RuntimeError(out.stderr)
    lines = out.stdout.splitlines()[1:]
    return {int(line.split()[0]): line.split(maxsplit=2)[1:] for line in lines}


def run(command, mutants, jobs):
    """Number of a mutant: its verdict and the case."""
    numbers = [mutant["number"] for mutant in mutants]
    parts = [part for i in range(jobs) if (part := numbers[i::jobs])]
    out = {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for found in pool.map(lambda part: run_part(command, part), parts):
            out.update(found)
    return out


def show(mutant, note=""):
    print(f"{mutant['file']}:{mutant['line']}: in {key_of(mutant)[1]}{note}\n"
          f"  - {mutant['old']}\n  + {mutant['new']}")


class Score:
    def __init__(self):
        self.by_file = collections.defaultdict(collections.Counter)

    def count(self, file, what):
        self.by_file[file][what] += 1
        self.by_file["all"][what] += 1

    def print(self):
        print(f"{'':44} mutants equivalent  free killed  alive of the rest")
        for file in sorted(self.by_file, key=lambda name: (name == "all", name)):
            counts = self.by_file[file]
            total = sum(counts.values())
            rest = counts["killed"] + counts["open"]
            share = f"{100 * counts['killed'] / rest:.1f} %" if rest else "-"
            print(f"{file:44} {total:7} {counts['equivalent']:10} {counts['free']:5} "
                  f"{counts['killed']:6} {counts['open']:6} {share:>11}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--file", default="")
    parser.add_argument("--jobs", type=int, default=min(4, os.cpu_count() or 1))
    parser.add_argument("--cases", default="conformance/cases")
    parser.add_argument("subject")
    parser.add_argument("mutants", type=pathlib.Path)
    parser.add_argument("run")
    parser.add_argument("target")
    options = parser.parse_args()
    path = HERE / "survivors" / f"{options.subject}.yaml"
    survivors = read_survivors(path)
    mutants = json.loads(options.mutants.read_text(encoding="utf-8"))
    wrong = 0
    for key in survivors.keys() - {key_of(mutant) for mutant in mutants}:
        wrong += 1
        print(f"it is listed, but no mutant: {', '.join(key)}")
    tried = [one for one in mutants[::options.every] if options.file in one["file"]]
    verdicts = run([options.run, options.target, options.cases], tried, options.jobs)
    score = Score()
    for mutant in tried:
        verdict, case = verdicts[mutant["number"]]
        entry = survivors.get(key_of(mutant))
        if verdict != "survived":
            score.count(mutant["file"], "killed")
            if entry:
                wrong += 1
                show(mutant, f": listed as a survivor, but {verdict} by {case}")
        else:
            score.count(mutant["file"], entry["kind"] if entry else "open")
            wrong += not entry
            if not entry or entry["kind"] == "open":
                show(mutant, "" if entry else ": not listed")
    score.print()
    if options.renew and tried == mutants:
        write_survivors(path, [(key_of(one), survivors.get(key_of(one))) for one in mutants
                               if verdicts[one["number"]][0] == "survived"])
    elif wrong:
        print(f"{wrong} mutants are not as survivors/{options.subject}.yaml says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
