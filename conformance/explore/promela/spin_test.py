#!/usr/bin/env python3
"""Compares spin's verdicts on join.pml with those of `rubric explore`: without a flaw and with
each, property by property, the two must agree.

Usage: spin_test.py RUBRIC [PROPERTY...]. Needs Debian's spin and gcc. Prints the table: `.` holds
for both, the network's sizes where both find it broken; a disagreement names who says what. Before
it, what both took for the networks without a flaw.

Usage: spin_test.py RUBRIC --figures: that alone.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools/tests"))
from readme.number import readme_number  # pylint: disable=wrong-import-position

MODEL = pathlib.Path(__file__).resolve().parent / "join.pml"
PROPERTIES = ["joined_after_reply", "ack_right_seq", "requests_bounded", "one_terminal",
              "one_island", "listed_acked", "listed_silent", "admitted", "one_report",
              "join_succeeds"]
FLAWS = [None, "accepts_wrong_seq", "one_pending_seq", "joined_on_link_ack", "no_fail",
         "seven_requests", "acks_wrong_seq", "answers_members"]
# Motes, sinks, calls of joinIsland each, whether frames may overtake, whether they may be doubled.
NETWORKS = [(1, 2, 2, False, False), (2, 1, 1, False, True), (1, 1, 1, True, True)]
REQUESTS = 2
ACKS = 2
# Goals that spin must find reachable in a network without flaws; the model denies them.
REACHABLE = ["never_first", "never_fail", "never_over"]
REACHABLE_WITH_TWO_SINKS = REACHABLE + ["never_second"]
SECONDS_MAX = 120
MEMORY_MAX_MB = 1024


class Pan:
    """The verifier that spin makes of the model, for one network and flaw."""

    def __init__(self, folder, network, flaw):
        self.folder = pathlib.Path(folder)
        motes, sinks, calls, reorder, dup = network
        defines = {"MOTES": motes, "SINKS": sinks, "CALLS": calls, "REQUESTS": REQUESTS,
                   "ACKS": ACKS, "DUPS": int(dup)}
        words = [f"-D{name}={value}" for name, value in defines.items()]
        words += [f"-D{flaw.upper()}"] if flaw else []
        words += ["-DREORDER"] if reorder else []
        self.run(["spin", *words, "-a", str(MODEL)])
        self.run(["gcc", "-O0", "-w", f"-DMEMLIM={MEMORY_MAX_MB}", "-o", "pan", "pan.c"])

    def run(self, words):
        return subprocess.run(words, cwd=self.folder, check=True, timeout=SECONDS_MAX, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT).stdout

    def figures(self):
        """States, transitions and bytes a state of the whole search for a claim that holds."""
        out = self.run(["./pan", "-m100000", "-w18", "-N", "requests_bounded"])
        if "errors: 0" not in out:
            sys.exit(f"spin's answer makes no sense:\n{out}")
        states = int(re.search(r"(\d+) states, stored", out)[1])
        steps = int(re.search(r"(\d+) transitions", out)[1])
        megabytes = float(re.search(r"([\d.]+)\s+equivalent memory usage for states", out)[1])
        return states, steps, round(megabytes * 2**20 / states)

    def breaks(self, claim):
        """Returns whether some run breaks the claim. Fails unless the search was complete."""
        out = self.run(["./pan", "-a", "-m100000", "-w18", "-N", claim])
        if "errors: 0" in out:
            for sign in ("out of memory", "max search depth too small", "Search not completed"):
                if sign in out:
                    sys.exit(f"spin did not search everything for {claim}: {sign}")
            return False
        if "errors: 1" in out:
            return True
        sys.exit(f"spin's answer for {claim} makes no sense:\n{out}")


def run_explorer(rubric, network, *more):
    motes, sinks, calls, reorder, dup = network
    words = [rubric, "explore", "--motes", motes, "--sinks", sinks, "--calls", calls, "--requests",
             REQUESTS, "--acks", ACKS, "--loss", "--format", "json", *more]
    words += ["--reorder"] if reorder else []
    words += ["--dup"] if dup else []
    words = [str(word) for word in words]
    return words, subprocess.run(words, timeout=SECONDS_MAX, text=True, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE)


def print_figures(rubric):
    """Both on the same networks: spin's own states, the explorer's without and with reductions."""
    print(f"{'motes x sinks':<16}{'by':<24}{'states':>9}{'transitions':>13}{'bytes/state':>13}"
          f"{'omission':>10}")
    for network in NETWORKS:
        size = f"{network[0]} x {network[1]}" + (", reorder" if network[3] else "")
        with tempfile.TemporaryDirectory() as folder:
            rows = [("spin", *Pan(folder, network, None).figures(), 0)]
        for name, words in [("rubric, no reduction", ["--no-symmetry", "--no-partial-order"]),
                            ("rubric", [])]:
            found = json.loads(run_explorer(rubric, network, *words)[1].stdout)
            rows.append((name, found["states"], found["transitions"],
                         found["memory_per_state_bytes"], found["omission_probability"]))
        for name, states, steps, size_bytes, omission in rows:
            print(f"{size:<16}{name:<24}{states:>9}{steps:>13}{size_bytes:>13}{omission:>10.0e}")
            size = ""


def explorer_breaks(rubric, network, flaw, claim):
    flawed = ["--flaw", flaw] if flaw else []
    words, done = run_explorer(rubric, network, "--property", claim, *flawed)
    verdict = re.search(r'"verdict": ?"(\w+)"|$', done.stdout)[1]
    if verdict == "broken" and done.returncode == 1:
        return True
    if verdict == "holds" and done.returncode == 0:
        return False
    if verdict == "vacuous" and flaw:
        return False  # A flaw may keep things from happening; no property is broken by that.
    if "never acted in this network" in done.stdout and done.returncode == 3:
        return False  # Spin's model has the flaw where it cannot act, too.
    sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout}{done.stderr}")


def compare(rubric, flaw, claims):
    """{claim: cell}, the number of disagreements, and whether anything is broken."""
    cells = {claim: [] for claim in claims}
    disagreements = 0
    for network in NETWORKS:
        with tempfile.TemporaryDirectory() as folder:
            pan = Pan(folder, network, flaw)
            if flaw is None:
                for claim in REACHABLE_WITH_TWO_SINKS if network[1] > 1 else REACHABLE:
                    if not pan.breaks(claim):
                        sys.exit(f"spin: {claim[6:]} is not reachable in {network}")
            for claim in claims:
                by_spin = pan.breaks(claim)
                by_explorer = explorer_breaks(rubric, network, flaw, claim)
                size = f"{network[0]}x{network[1]}" + ("r" if network[3] else "")
                if by_spin != by_explorer:
                    disagreements += 1
                    cells[claim].append(f"{size}:{'spin' if by_spin else 'explorer'}-only")
                elif by_spin:
                    cells[claim].append(size)
    return cells, disagreements, any(cells.values())


def main():
    rubric = str(pathlib.Path(sys.argv[1]).resolve())
    if sys.argv[2:] == ["--figures"]:
        return print_figures(rubric)
    claims = sys.argv[2:] or PROPERTIES
    assert len(PROPERTIES) == readme_number("explorer on # properties")
    assert len(FLAWS) - 1 == readme_number("properties, # flaws")
    assert len(NETWORKS) == readme_number("flaws and # networks")
    wrong = 0
    print_figures(rubric)
    print(f"{'broken in':<20}" + "".join(f"{flaw or 'no flaw':<20}" for flaw in FLAWS))
    columns = []
    for flaw in FLAWS:
        cells, disagreements, broken = compare(rubric, flaw, claims)
        columns.append(cells)
        wrong += disagreements
        # Nothing is broken without a flaw, and something with each.
        if broken == (flaw is None):
            wrong += 1
            print(f"{flaw or 'no flaw'}: {'something' if broken else 'nothing'} is broken")
    for claim in claims:
        print(f"{claim:<20}" + "".join(f"{','.join(c[claim]) or '.':<20}" for c in columns))
    print(f"{wrong} disagreements")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
