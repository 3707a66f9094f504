#!/usr/bin/env python3
"""Tries fuzz/run, fuzz/smoke and fuzz/minimize on a small target with a planted bug, and
mutated_files_test.py on a program that breaks at one file.

Usage: fuzz/scripts_test.py [CLANG]. It works on copies of the scripts in a folder of its own.
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

FUZZ = pathlib.Path(__file__).resolve().parent
CLANG = "clang++-14"
TARGET = """// Property: no input
// says deep.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
namespace rubric {
volatile int reached = 0;  // so that each step stays a branch
__attribute__((noinline)) void third(char c) {
  reached = 3;
  if (c != 'p' || !TRAP) return;
  std::fputs("broken: no input says deep\\n", stderr);
  std::abort();
}
__attribute__((noinline)) void second(char c, char next) {
  reached = 2;
  if (c == 'e') third(next);
}
__attribute__((noinline)) void first(char c, char next, char last) {
  reached = 1;
  if (c == 'e') second(next, last);
}
}  // namespace rubric
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4 || data[0] != 'd') return 0;
  rubric::first(char(data[1]), char(data[2]), char(data[3]));
  return 0;
}
"""

PROGRAM = """#!/usr/bin/env python3
import glob, os, sys
if "--each" not in sys.argv:
    sys.exit(int(os.environ["CODE"]) if "00042.yaml" in sys.argv[-1] else 0)
for file in sorted(glob.glob(sys.argv[sys.argv.index("--each") + 1])):
    code = os.environ["CODE"] if "00042." in file else 0
    if code == "-9":
        os.kill(os.getpid(), 9)
    print('{"exit_code":%s}' % code, flush=True)
"""


class ScriptsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        for name in ("support", "targets"):
            (self.root / "fuzz" / name).mkdir(parents=True)
        for name in ("run", "smoke", "minimize", "support/targets.py"):
            shutil.copy2(FUZZ / name, self.root / "fuzz" / name)
        (self.root / "fuzz/targets/deep_fuzz.cc").write_text(TARGET, encoding="utf-8")
        self.corpus = self.root / "fuzz/corpora/deep"
        self.corpus.mkdir(parents=True)
        (self.corpus / "start.txt").write_bytes(b"deer")

    def build(self, trap):
        """A build folder with the target, with or without its bug."""
        build = self.root / f"build/trap{trap}"
        (build / "fuzz").mkdir(parents=True)
        line = "deep\t-\t16\t20000\tfuzz/corpora/deep\t20\trepro\n"
        (build / "fuzz_targets.tsv").write_text(line, encoding="utf-8")
        subprocess.run([CLANG, "-g1", "-O1", "-fsanitize=fuzzer", f"-DTRAP={trap}", "-o",
                        build / "fuzz/deep_fuzz", self.root / "fuzz/targets/deep_fuzz.cc"],
                       check=True)
        return build

    def script(self, *words):
        return subprocess.run([self.root / "fuzz" / words[0], *words[1:]], cwd=self.root,
                              capture_output=True, text=True, check=False, timeout=120)

    def names(self):
        return sorted(f.name for f in self.corpus.iterdir())

    def test_a_bug_is_found_and_the_command_shows_it_again(self):
        done = self.script("run", "deep", "60", "--build", self.build(1))
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("deep: broken: no input says deep", done.stdout)
        again = [x.strip() for x in done.stdout.splitlines() if x.startswith("  again: ")]
        self.assertEqual(len(again), 1, done.stdout)
        command = again[0].split()[1:]
        self.assertIn("build/fuzzing/deep/finds/crash-", command[1])
        self.assertIn(f"rubric repro deep {command[1]}", done.stdout)
        shown = subprocess.run(command, cwd=self.root, capture_output=True, check=False)
        self.assertNotEqual(shown.returncode, 0)
        self.assertEqual(self.names(), ["start.txt"])

    def test_a_sound_target_runs_for_its_time_and_can_be_listed(self):
        build = self.build(0)
        done = self.script("run", "all", "2", "--build", build)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        row = [x.split() for x in done.stdout.splitlines() if x.startswith("deep ")][-1]
        self.assertGreater(int(row[1]), 1000)
        self.assertEqual(row[-1], "0")
        self.assertEqual(self.names(), ["start.txt"])
        done = self.script("run", "--list", "--build", build)
        self.assertIn("1 seeds  no input says deep", done.stdout)
        self.assertIn("no such target", self.script("run", "deer", "--build", build).stderr)

    def test_ctrl_c_ends_it_with_the_table(self):
        command = [self.root / "fuzz/run", "deep", "60", "--build", self.build(0)]
        with subprocess.Popen(command, cwd=self.root, stdout=subprocess.PIPE, text=True) as run:
            time.sleep(3)
            started = time.monotonic()
            run.send_signal(signal.SIGINT)
            printed, _ = run.communicate(timeout=30)
        self.assertLess(time.monotonic() - started, 20)
        self.assertEqual(run.returncode, 130, printed)
        self.assertIn("target ", printed)

    def test_smoke_makes_the_runs_of_the_table_and_fails_on_a_bug(self):
        done = self.script("smoke", self.build(0))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"deep +20000 runs")
        (self.corpus / "bug.txt").write_bytes(b"deep")
        done = self.script("smoke", self.build(1))
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("broken: no input says deep", done.stdout)

    def test_minimize_takes_what_is_new_and_drops_what_is_not(self):
        build = self.build(0)
        (self.corpus / "start.txt").write_bytes(b"none")
        (self.corpus / "named.txt").write_bytes(b"nine")
        (self.corpus / "bug-old.txt").write_bytes(b"ten")
        (self.corpus / "found-old.txt").write_bytes(b"nothing")
        finds = self.root / "build/fuzzing/deep/corpus"
        finds.mkdir(parents=True)
        for number, text in enumerate((b"dxxx", b"dexx", b"deex", b"deeper", b"x" * 17)):
            (finds / str(number)).write_bytes(text)
        done = self.script("minimize", "deep", "--build", build)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        names = self.names()
        self.assertIn("dropped fuzz/corpora/deep/found-old.txt", done.stdout)
        self.assertTrue({"start.txt", "named.txt", "bug-old.txt"} <= set(names), names)
        added = set(names) - {"start.txt", "named.txt", "bug-old.txt"}
        self.assertTrue(added)
        for name in added:
            self.assertRegex(name, r"^found-[0-9a-f]{8}\.txt$")
        again = self.script("minimize", "deep", "--build", build)
        self.assertNotIn("added", again.stdout)
        self.assertEqual(self.names(), names)
        self.script("minimize", "deep", "--build", build, "--prune")
        self.assertIn("bug-old.txt", self.names())
        self.assertLess(len(self.names()), len(names))

    def test_mutated_files_that_break_are_told(self):
        program = self.root / "program"
        program.write_text(PROGRAM, encoding="utf-8")
        program.chmod(0o755)
        for kind, code, says in (("bin", 3, "100 files, 0 are"), ("bin", 99, "{'exit_code': 99}"),
                                 ("yaml", 99, "ends with 99: "),
                                 ("bin", -9, "ends with -9 or hangs after 42 files")):
            done = subprocess.run(
                [sys.executable, FUZZ / "mutated_files_test.py", program, kind, "100"],
                capture_output=True, text=True, check=False,
                env={**os.environ, "CODE": str(code), "TMPDIR": str(self.root)})
            self.assertEqual(done.returncode, code != 3, done.stderr)
            self.assertIn(says, done.stdout)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        CLANG = sys.argv.pop(1)
    unittest.main()
