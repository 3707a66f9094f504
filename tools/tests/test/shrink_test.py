"""rubric shrink and rubric diff on broken machines behind rct/1."""
import contextlib
import pathlib
import sys
import tempfile
import unittest

from testing import ROOT, Folder, ProgramTest, rubric as run

MACHINE = sys.argv.pop(1)
CASE = ROOT / "conformance/cases/j4.rtr"
BROKEN = f"{MACHINE} --mutant wrong_seq_accepted_and_acked_as_it_is"


# It refuses what nobody knows, but says that it joined whatever it is asked.
LIAR = """
import sys
for line in sys.stdin:
    words = line.split()
    if words[0] == "hello": print("hello rct/1 liar 1 roles=mote time=virtual")
    elif words[0] == "reset": print("ready")
    elif words[0] == "call" and words[2].startswith("join("):
        print(f"up {words[1]} joined(10053:5 success)\\nnext -\\ndone {words[1]}")
    elif words[0] in ("call", "rx", "linkack", "line", "power", "until"):
        print(f"next -\\ndone {words[1]}")
    elif words[0] == "bye": break
    else: print("unsupported")
    sys.stdout.flush()
"""


# The machine, and with seed 7 the broken one.
MOODY = f"""
import subprocess, sys
both = [subprocess.Popen(words, shell=True, text=True, bufsize=1, stdin=subprocess.PIPE,
                         stdout=subprocess.PIPE) for words in ({MACHINE!r}, {BROKEN!r})]
chosen = 0
for line in sys.stdin:
    if line.startswith("reset"): chosen = int("seed=7 " in line)
    for i, one in enumerate(both):
        if i != chosen and not line.startswith(("hello", "bye")): continue
        one.stdin.write(line)
        while not line.startswith("bye"):
            answer = one.stdout.readline()
            if i == chosen: print(answer, end="", flush=True)
            if answer.split(maxsplit=1)[0] in ("hello", "ready", "done", "unsupported"): break
"""


@contextlib.contextmanager
def moody():
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder, "moody.py")
        script.write_text(MOODY, encoding="utf-8")
        yield f"{sys.executable} {script}"


class Shrink(Folder):
    def test_a_failing_trace_becomes_a_smaller_golden_trace(self):
        small = self.folder / "small.rtr"
        code, out, err = run("shrink", CASE, "--target", BROKEN, "--out", small)
        self.assertEqual((code, out), (0, ""), err)
        text = small.read_text(encoding="utf-8")
        self.assertIn("case j4.wrong_seq.shrunk", text)
        lines = [line for line in text.splitlines() if " m5 " in line and line[0] != ";"]
        self.assertLess(len(lines), 8, text)
        code, out, err = run("test", "--target", BROKEN, small)
        self.assertEqual(code, 1, out + err)
        self.assertIn("J4-SEQ", out)
        code, out, err = run("test", "--target", "machine", small)
        self.assertEqual(code, 0, out + err)

    def test_what_is_made_holds_whatever_number_comes_first(self):
        small = self.folder / "small.rtr"
        self.assertEqual(run("shrink", CASE, "--target", BROKEN, "--out", small)[0], 0)
        for seed in ["0", "58392", "58647"]:
            code, out, err = run("test", "--target", "machine", "--seed", seed, small)
            self.assertEqual(code, 0, out + err)

    def test_profile(self):
        self.shows(("shrink", str(ROOT / "conformance/cases/j8.rtr"), "--target", "machine",
                    "--profile", "deployed", "--case", "j8.at_most_five"), "[J8-LIMIT")

    def test_a_seed_is_in_what_is_made(self):
        with moody() as target:
            self.assertEqual(run("shrink", CASE, "--target", target)[0], 3)
            self.shows(("shrink", CASE, "--target", target, "--seed", "7"), "%seed 7\n")

    def test_an_adapter_that_says_yes_to_everything(self):
        """It passes what nobody can pass: what it does otherwise says nothing."""
        liar = self.write("liar.py", LIAR)
        target = f"{sys.executable} {liar}"
        for words in [("shrink", CASE, "--target", target),
                      ("diff", "--target", "machine", "--target", target, "--cases", "j4.*")]:
            self.refused(words, f"rubric {words[0]}: {target}: canary.mote has to fail", 2)

    def test_nothing_to_shrink(self):
        self.refused(("shrink", CASE, "--target", "machine"), "nothing fails", 3)

    def test_unknown_case(self):
        self.refused(("shrink", CASE, "--target", "machine", "--case", "j4.no"),
                     "has no case j4.no")

    def test_unreadable(self):
        code, _, err = run("shrink", "nowhere.rtr", "--target", "machine")
        self.assertEqual(code, 66, err)

    def test_an_unknown_target(self):
        code, _, err = run("shrink", CASE, "--target", "exit 3", "--timeout", "2")
        self.assertEqual(code, 2, err)


class Diff(ProgramTest):
    def test_a_seed(self):
        with moody() as target:
            words = ["diff", "--target", "machine", "--target", target, "--cases", "j4.*"]
            self.assertEqual(run(*words)[0], 0)
            self.shows((*words, "--seed", "7"), "%seed 7\n", code=1)

    def test_a_mutant_and_the_machine(self):
        self.shows(("diff", "--target", "machine", "--target", BROKEN, "--rule", "J4"),
                   ".difference", "; A, ", "; B, ", code=1)

    def test_the_profiles(self):
        self.shows(("diff", "--target", "machine", "--target", "machine", "--profile", "paper",
                    "--profile", "deployed", "--rule", "J8"), "J8", code=1)

    def test_a_death_at_reset(self):
        """It tells the two apart, and where both die nothing is compared."""
        dies = f"sed -u '/^reset .*id=5 .*seed=9 /Q' | {MACHINE}"
        words = ["diff", "--cases", "j1.request", "--cases", "j1.new_number",
                 "--seed", "9", "--target"]
        self.shows((*words, "machine", "--target", dies), "; A, rubric_machine 1: pass\n",
                   "; B, rubric_machine 1: fail: J1-REQUEST: `reset ", code=1)
        code, out, err = run(*words, dies, "--target", dies)
        self.assertEqual((code, out), (3, ""), err)
        self.assertIn("2 not compared, since both died, hung or wrote nonsense\n  j1.", err)

    def test_a_target_and_itself(self):
        code, out, err = run("diff", "--target", "machine", "--target", MACHINE, "--cases", "j*")
        self.assertEqual((code, out), (0, ""), err)
        self.assertIn("0 differ", err)

    def test_traces_may_be_between_the_options(self):
        code, _, err = run("diff", "--target", "machine", "conformance/cases/j1.rtr", "--target",
                           MACHINE)
        self.assertEqual(code, 0, err)

    def test_one_target_is_not_enough(self):
        self.refused(("diff", "--target", "machine"), "twice")


if __name__ == "__main__":
    unittest.main(verbosity=1)
