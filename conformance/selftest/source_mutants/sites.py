"""Mutants of one source file, and a copy of the file that contains all of them behind a switch."""

import dataclasses
import re


@dataclasses.dataclass(frozen=True)
class Edit:
    """A range of the file's characters and its new text. A statement's range has its semicolon."""
    begin: int
    end: int
    text: str
    statement: bool = False
    condition: bool = False     # An expression that is converted to bool.


@dataclasses.dataclass
class Mutant:
    file: str       # Relative to the project.
    function: str
    edits: tuple
    number: int = 0
    line: int = 0
    old: str = ""   # The lines that it changes, without the indentation,
    new: str = ""   # and the same lines changed.
    nth: int = 1    # Counts mutants of one function with the same old and new text.

    def key(self):
        return self.file, self.function, self.old, self.new


def one_line(text):
    return re.sub(r"\s+", " ", text).strip()


def describe(mutants, source):
    """Fills in what identifies a mutant even where lines have moved."""
    seen = {}
    for mutant in mutants:
        begin = min(edit.begin for edit in mutant.edits)
        end = max(edit.end for edit in mutant.edits)
        first = source.rfind("\n", 0, begin) + 1
        last = source.find("\n", end)
        changed = source[first:last]
        for edit in sorted(mutant.edits, key=lambda edit: -edit.begin):
            changed = changed[:edit.begin - first] + edit.text + changed[edit.end - first:]
        mutant.line = source.count("\n", 0, begin) + 1
        mutant.old = one_line(source[first:last])
        mutant.new = one_line(changed)
        seen[mutant.key()] = mutant.nth = seen.get(mutant.key(), 0) + 1


def unique(mutants):
    """Drops mutants that change the file in the same way as one before, in order of place."""
    out = {}
    for mutant in mutants:
        edits = tuple(sorted((edit.begin, edit.end, edit.text) for edit in mutant.edits))
        out.setdefault(edits, mutant)
    return [out[edits] for edits in sorted(out)]


def render(source, mutants, wrap):
    """Returns the source with all mutants in it. wrap(inner, edits, numbers) makes the text of one
    range, of which all `edits` are alternatives."""
    sites = {}
    for mutant in mutants:
        for edit in mutant.edits:
            sites.setdefault((edit.begin, edit.end), []).append((mutant.number, edit))
    # Outer ranges first; those that begin together by size.
    ranges = sorted(sites, key=lambda site: (site[0], -site[1]))

    def text_of(begin, end, inner):
        out = []
        at = begin
        while inner:
            site = inner.pop(0)
            children = []
            while inner and inner[0][0] < site[1]:
                child = inner.pop(0)
                if child[1] > site[1]:
                    raise ValueError(f"ranges {site} and {child} overlap")
                children.append(child)
            out.append(source[at:site[0]])
            out.append(wrap(text_of(*site, children), sites[site]))
            at = site[1]
        out.append(source[at:end])
        return "".join(out)

    return text_of(0, len(source), ranges)
