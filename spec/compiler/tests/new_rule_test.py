#!/usr/bin/env python3
"""A new rule changes no other rule's number, so few files are compiled again.

Usage: new_rule_test.py RUBRICC EMITTERS FILE.ksy...   (in the project's folder)

Adds a rule of the wire and one of behaviour in the midst of a copy of the catalogue, generates
everything, and compares with what is checked in. Then counts the sources that see a file which a
rule, its golden trace or its entry in a profile changes.
"""

import collections
import pathlib
import re
import subprocess
import sys
import tempfile

MOST_SOURCES = 30
CATALOGUE = "codec/generated/requirements_table.h"
WIRESHARK = "tools/wireshark/generated/rubric.lua"  # Shows the texts of wire rules.
OF_RULES = {CATALOGUE, "conformance/generated/blame.h", "conformance/generated/cases.h",
            "conformance/generated/profiles.h"}
NEW_RULE = """- id: {}
  level: MUST
  clause: wire
  sentence: "Nothing follows from it."
  source: "nowhere"

"""


def with_new_rules(text):
    for after, new in ("WIRE-SF-LENGTH", "WIRE-ADDED"), ("J4-SEQ", "J4-ADDED"):
        text = text.replace(f"- id: {after}\n", NEW_RULE.format(new) + f"- id: {after}\n")
    return text


def changed(rubricc, emitters, specs):
    """The generated files that differ from those that are checked in."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        # The path stays as it is, since headers name it.
        catalogue = out / "spec/requirements.yaml"
        catalogue.parent.mkdir()
        text = pathlib.Path("spec/requirements.yaml").read_text(encoding="utf-8")
        catalogue.write_text(with_new_rules(text), encoding="utf-8")
        subprocess.run([rubricc, "--requirements", catalogue, "--emit", emitters, "--out", folder,
                        *specs], check=True)
        catalogue.unlink()
        made = [path for path in out.rglob("*") if path.is_file()]
        assert len(made) > 50, made
        return {str(path.relative_to(out)) for path in made
                if path.read_bytes() != pathlib.Path(path.relative_to(out)).read_bytes()}


def sources_that_see(headers):
    """The .cc files that include one of the headers, directly or not."""
    users = collections.defaultdict(set)
    for area in ("codec", "conformance", "fuzz", "spec", "tools"):
        for path in pathlib.Path(area).rglob("*.*"):
            if path.suffix not in {".cc", ".h"}:
                continue
            text = path.read_text(encoding="utf-8")
            for header in re.findall(r'^ *#include "([^"]+)"', text, re.M):
                users[header].add(str(path))
    seen, waiting = set(headers), list(headers)
    while waiting:
        new = users[waiting.pop()] - seen
        seen |= new
        waiting += new
    return sorted(path for path in seen if path.endswith(".cc"))


def main():
    faults = []
    found = changed(sys.argv[1], sys.argv[2], sys.argv[3:])
    if found != {CATALOGUE, WIRESHARK}:
        faults.append(f"a new rule changes {sorted(found)}")
    one, all_three = sources_that_see({CATALOGUE}), sources_that_see(OF_RULES)
    print(f"a new rule compiles {len(one)} sources again, with its golden trace and an entry in a "
          f"profile {len(all_three)}; at most {MOST_SOURCES}")
    if not one or len(all_three) > MOST_SOURCES:
        faults.append(f"these see the catalogue: {all_three}")
    everything = len(sources_that_see({"codec/runtime/rule.h"}))
    if everything < 200:
        faults.append(f"includes are not found: only {everything} sources see a rule's number")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
