#!/usr/bin/env python3
"""The lists of tools/expect are what release 1.0 breaks, and blame no rule that it keeps."""

import json
import pathlib
import re
import tempfile
import unittest

from testing import ROOT, ProgramTest, rubric

LISTS = ROOT / "tools/expect"
CAPTURES = ROOT / "spec/captures"
EVENTS = ROOT / "conformance/check/tests/testdata"

# What the captures and the sources of release 1.0 show to be broken; weak ones among them.
BROKEN = {
    "firmware": "J2-LISTED J3-TIME J4-SEQ J6-ADD J8-FAIL J8-LIMIT J9-INTERLEAVE N1-SIZE N11-NBYTES "
                "N2-IN-FULL N2-IN-ORDER N6-OTHER N7-FOREIGN S1-MODE S2-SIGNAL S3-OLD S3-UNCHANGED "
                "S6-DISPOSED T3-MATCH T3-SENDER T3-SUCCESS T3-TIMEOUT",
    "base_station": "N11-NBYTES N11-SHORT N8-INCOMING N8-PEIS T2-BROADCAST T2-CONTENT "
                    "T3-TIMEOUT",
}
# Broken as well, perhaps by what breaks others: no clock, no list, neither failure nor timeout is
# told, and an ack too many.
FOLLOWS = {
    "firmware": {"J3-DRIFT": {"J3-TIME"}, "J3-OVERWRITE": {"J2-LISTED"}, "J5-ONCE": {"J8-FAIL"},
                 "T3-ONCE": {"T3-MATCH", "T3-TIMEOUT"}},
    "base_station": {"T2-ACK": {"T2-BROADCAST"}},
}


def machine(name):
    return ["test", "--target", f"machine:release_1_0_{name}", "--format", "json", "--expect"]


class Check(ProgramTest):
    def matched(self, name, runs):
        """Each run is as expected; returns the lines of entries that came true."""
        out = set()
        for files in runs:
            code, text, err = rubric("check", "--format", "json", "--expect",
                                     LISTS / f"{name}.check.yaml", *files)
            report = json.loads(text)
            self.assertTrue(report["expected"], files)
            nothing = report["verdict"] == "inconclusive" and code == 3
            self.assertEqual(code, 3 if nothing else 0, f"{files} {err}")
            out |= {one["line"] for one in report["expectations"] if one["came"] == "matched"}
        return out

    def holds(self, name, runs):
        text = (LISTS / f"{name}.check.yaml").read_text(encoding="utf-8")
        entries = sum(line.startswith("- ") for line in text.splitlines())
        self.assertGreater(entries, 0)
        self.assertEqual(len(self.matched(name, runs)), entries, "an entry never happens")

    def test_firmware(self):
        captures = sorted((CAPTURES / "firmware").glob("*.pcapng"))
        self.assertGreater(len(captures), 12)
        runs = [["--profile", profile, file]
                for file in captures for profile in ("paper", "deployed")]
        # One clock stamped both.
        runs += [["--profile", "deployed", "--skew", "0", file, EVENTS / f"{file.stem}.app.rtr"]
                 for file in captures]
        runs += [[file] for file in sorted((CAPTURES / "firmware").glob("*.serial.bin"))]
        self.holds("firmware", runs)

    def test_base_station(self):
        streams = sorted((CAPTURES / "basestation").glob("*.sfstream"))
        self.assertGreater(len(streams), 10)
        self.holds("base_station", [[file] for file in streams])
        # Both directions at once leave their order open, and with it failures of the list.
        names = sorted({file.name.partition(".")[0] for file in streams})
        self.matched("base_station", [[file for file in streams if file.name.startswith(name)]
                                      for name in names] + [streams])


class Test(ProgramTest):
    def test_as_measured(self):
        for name, broken in BROKEN.items():
            code, out, err = rubric(*machine(name), LISTS / f"{name}.test.yaml")
            self.assertEqual(code, 0, out[-2000:] + err)
            run = json.loads(out)["implementations"][0]
            self.assertEqual(" ".join(sorted(rule["id"] for rule in run["requirements"]
                                             if rule["broken"])), broken)
            failures = [failure for case in run["cases"] for failure in case["failures"]]
            self.assertEqual({rule: {one["cause"] for one in failures
                                     if one["cause"] and one["requirements"] == [rule]}
                              for rule in FOLLOWS[name]}, FOLLOWS[name])

    def test_without_an_entry_and_with_one_that_never_happens(self):
        for name in BROKEN:
            text = (LISTS / f"{name}.test.yaml").read_text(encoding="utf-8")
            head, first, *others = text.split("\n- case:")
            case, rule = re.search(r"([\w.]+)\s(?:.*\s)*?  requirement: (\S+)", first).groups()
            never = f"\n- {{case: {case}, requirement: {rule}, message: never, reason: x}}\n"
            with tempfile.TemporaryDirectory() as folder:
                known = pathlib.Path(folder, "known.yaml")
                for changed in ("\n- case:".join([head, *others]), text + never):
                    known.write_text(changed, encoding="utf-8")
                    code, out, _ = rubric(*machine(name), known, "--cases", case)
                    self.assertEqual(code, 1, out[-2000:])

    def test_a_list_of_the_wrong_kind_says_so(self):
        capture = CAPTURES / "firmware/a_join_data.pcapng"
        for name in BROKEN:
            self.refused(("check", capture, "--expect", LISTS / f"{name}.test.yaml"),
                         "belongs to a list for rubric test; this one is for rubric check")
            self.refused((*machine(name), LISTS / f"{name}.check.yaml"),
                         "belongs to a list for rubric check; this one is for rubric test")


if __name__ == "__main__":
    unittest.main()
