#!/usr/bin/env python3
"""Each adapter that `rubric new-adapter` writes is built, run and spoken to.

Usage: new_adapter_test.py RUBRIC
"""

import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from testing import Folder, rubric, run

SKELETONS = {
    "python": ([], ["python3", "adapter.py"], "mote"),
    "cpp": (["g++", "-std=c++17", "-Wall", "-Wextra", "-Wshadow", "-Wconversion", "-Werror",
             "-o", "my_node", "adapter.cc"], ["./my_node"], "mote"),
    "java": (["javac", "-Xlint:all", "-Werror", "Adapter.java", "MyNode.java", "World.java"],
             ["java", "-cp", ".", "Adapter"], "mote"),
}
# A command, and the lines of its answer: exact ones, and beginnings where they end in "...".
CONVERSATION = [
    ("until 5", ["unsupported ..."]),    # Nothing was reset yet.
    ("hello rct/1", ["hello rct/1 my_..."]),
    ("no_such_command 7", ["unsupported ..."]),
    ("reset nobody id=5 island=11 channels=4 seed=0 profile=paper", ["unsupported ..."]),
    ("reset ROLE id=5 island=11 channels=4 seed=3 profile=paper members=2",
     ["unsupported members"]),
    ("reset ROLE id=5 island=11 channels=4 seed=3 profile=paper", ["ready"]),
    ("call 0 get_clock()", ["up 0 clock(0)", "next -", "done 0"]),
    ("until 1024", ["next -", "done 1024"]),
    ("call 1024 get_clock()", ["up 1024 clock(1000)", "next -", "done 1024"]),
    ("call 1024 send(dest=11:2 app_id=5 reliable=1 data=x0a0b)", ["unsupported call send"]),
    ("no_such_command", ["unsupported ..."]),
    ("rx 1030 radio 0000050001030022010203", ["next -", "done 1030"]),
    ("line 1040 radio busy", ["next -", "done 1040"]),
    ("linkack 1050 1", ["next -", "done 1050"]),
    ("power 1060 off", ["next -", "done 1060"]),
    ("call 1070 get_clock()", ["next -", "done 1070"]),    # Nobody is there.
    ("power 1080 reboot", ["next -", "done 1080"]),
    ("call 2104 get_clock()", ["up 2104 clock(1000)", "next -", "done 2104"]),
    ("reset ROLE id=6 island=12 channels=8 seed=0 profile=deployed", ["ready"]),
    ("call 0 get_clock()", ["up 0 clock(0)", "next -", "done 0"]),
]


def is_as(expected, line):
    return line.startswith(expected[:-3]) if expected.endswith("...") else line == expected


class NewAdapter(Folder):
    def made(self, language, folder):
        return run("new-adapter", language, "--out", folder, text=True)

    def speak(self, command, folder, role):
        child = subprocess.Popen(command, cwd=folder, stdin=subprocess.PIPE,
                                 stdout=subprocess.PIPE, text=True)
        for given, answer in CONVERSATION:
            child.stdin.write(given.replace("ROLE", role) + "\n")
            child.stdin.flush()
            for expected in answer:
                line = child.stdout.readline().rstrip("\n")
                self.assertTrue(is_as(expected, line), f"{given}: {line!r}, not {expected!r}")
        rest, _ = child.communicate("bye\n", timeout=20)
        self.assertEqual((rest, child.returncode), ("", 0))

    def test_each_language(self):
        for language, (build, node, role) in SKELETONS.items():
            with self.subTest(language):
                out = self.folder / language / "new/adapter"
                written = self.made(language, out)
                self.assertEqual((written.returncode, written.stderr), (0, ""))
                self.assertIn("rubric test --target", written.stdout)
                text = "".join(file.read_text() for file in out.iterdir())
                self.assertIn("TODO", text)
                if build:
                    subprocess.run(build, cwd=out, check=True)
                self.speak(node, out, role)
                self.try_suite(node, out)

    def try_suite(self, node, folder):
        """Nothing fails, but nothing is green either unless what the node cannot do is listed."""
        def tried(*words):
            code, out, err = rubric("test", "--target", " ".join(node), "--format", "tap", *words,
                                    cwd=folder)
            self.assertEqual(err, "")
            return code, out
        code, out = tried()
        self.assertEqual(code, 3, out)
        self.assertGreater(len(re.findall(r"^not ok .*: ", out, re.M)), 100)
        code, out = tried("--expect", "known.yaml")
        self.assertEqual(code, 0, out)
        results = [line for line in out.splitlines() if re.match("(not )?ok ", line)]
        passed = [line for line in results if line.startswith("ok ") and "# SKIP" not in line]
        self.assertGreaterEqual(len(passed), 3)
        self.assertIn("# SKIP skip: The node has no join() yet.", out)
        self.assertNotIn("not ok", out)
        known = folder / "known.yaml"
        known.write_text(known.read_text().replace("    - j1.request\n", "", 1))
        code, out = tried("--expect", "known.yaml")
        self.assertEqual(code, 3)
        self.assertEqual(out.count("not ok"), 1)

    def test_overwrites_nothing(self):
        mine = self.write("my_node.h", "mine")
        self.refused(("new-adapter", "cpp", "--out", self.folder), "my_node.h: it exists", 74)
        self.assertEqual(mine.read_text(), "mine")
        self.assertEqual([mine], list(self.folder.iterdir()))

    def test_mistakes(self):
        self.assertEqual(self.made("cobol", "x").returncode, 64)
        self.assertFalse(pathlib.Path("x").exists())
        file = self.write("file", "")
        self.refused(("new-adapter", "python", "--out", file / "deep"), "cannot write", 74)


if __name__ == "__main__":
    if shutil.which("javac") is None:
        sys.exit("javac is missing; tools/install-packages test installs it")
    unittest.main()
