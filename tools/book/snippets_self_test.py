#!/usr/bin/env python3
"""Faults that snippets.py and texts.py must find.

Usage: snippets_self_test.py PATH_TO_RUBRIC
"""

import pathlib
import sys
import tempfile
import unittest
import unittest.mock

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import snippets  # pylint: disable=wrong-import-position
from book import texts  # pylint: disable=wrong-import-position

ROOT = HERE.parents[1]
RUBRIC = pathlib.Path(sys.argv.pop(1)).resolve()
VIEW = """#include "codec/generated/rubicon/config.h"
int main() {{
  const uint8_t bytes[] = {{10, 0, 12}};
  const auto config = rubric::rubicon::ConfigView::parse(bytes);
  {}
}}
"""


class Snippets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="rubric-snippets-")
        cls.place = snippets.Place(cls.scratch.name, ROOT, RUBRIC.parent)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def works(self, text):
        self.assertEqual(snippets.renewed(text, self.place), (text, []))

    def fails(self, text, line, why):
        now, wrong = snippets.renewed(text, self.place)
        self.assertEqual([at for at, _ in wrong], [line], wrong)
        self.assertIn(why, wrong[0][1])
        return now

    def test_console(self):
        self.works("```console\n$ echo a; echo b >&2\na\nb\n$ echo \\\n  c\nc\n```\n")
        now = self.fails("text\n\n```console\n$ echo right\nwrong\n```\n", 3, "should show")
        self.assertEqual(now, "text\n\n```console\n$ echo right\nright\n```\n")
        self.fails("```console\n$ true\nmore\n```\n", 1, "should show")
        self.fails("```console\nno command\n```\n", 1, "begins with")
        self.fails("```console\n$ kill -SEGV $$\n```\n", 1, "signal")

    def test_the_program_is_that_of_the_build_folder(self):
        self.works("```console\n$ echo 0a000c | rubric decode --as config --fields value\n"
                   "     1 value=12\n```\n")
        self.works("```\n$ echo 0a000c | build/release/rubric decode --as config --fields value\n"
                   "     1 value=12\n```\n")

    def test_files_and_patches(self):
        self.works("```yaml file=in/known.yaml\n- a\n```\n\n"
                   "```diff\n--- in/known.yaml\n+++ in/known.yaml\n@@ -1 +1 @@\n-- a\n+- b\n```\n\n"
                   "```console\n$ cat in/known.yaml\n- b\n```\n")
        self.fails("```diff\n--- none\n+++ none\n@@ -1 +1 @@\n-a\n+b\n```\n", 1, "patch")

    def test_programs(self):
        good = VIEW.format("return config ? 0 : 1;")
        self.works(f"```cpp file=good.cc\n{good}```\n\n```output\n```\n")
        self.fails(f"```cpp file=warned.cc\n{VIEW.format('')}```\n", 1, "unused")
        self.fails(f"```cpp file=broken.cc\n{VIEW.format('return none;')}```\n", 1, "none")
        self.fails(f"```cpp file=bad.cc\n{VIEW.format('return config ? 1 : 0;')}```\n\n"
                   "```output\n```\n", 10, "ends with 1")
        self.fails(f"```cpp file=same.cc\n{good}```\n\n```output\nmore\n```\n", 10, "should show")
        self.fails("```output\n```\n", 1, "follows a cpp block")

    def test_options_of_what_is_not_run(self):
        self.works("```sh\nrubric decode x --follow --count 2 | head -n 1   # no --such\n```\n")
        self.fails("```sh\nrubric decode \\\n  --such x\n```\n", 1, "has no option --such")
        self.fails("```sh\nrubric undecode x\n```\n", 1, "no `rubric undecode`")

    def test_what_is_only_read(self):
        self.works("```cpp\nno program\n```\n\n```text\n$ nothing\n```\n")


class Texts(unittest.TestCase):
    def test_a_text_and_its_links(self):
        mistakes = unittest.mock.Mock()
        with tempfile.TemporaryDirectory() as scratch:
            root = pathlib.Path(scratch)
            (root / "a").mkdir()
            (root / "a/b.md").write_text("# B\n[c.h](../c.h) [the loop](c/d.py#e) [x](#x)\n"
                                         "[y](https://y.example)\n```\n[c.h](c.h)\n```\n")
            chapter = root / "01.md"
            chapter.write_text("{{text a/b.md}}\nend\n{{text none.md}}\n")
            lines = texts.lines_of(chapter, root, mistakes)
        self.assertEqual(lines, ["# B", "`c.h` the loop (`a/c/d.py`) [x](#x)",
                                 "[y](https://y.example)", "```", "[c.h](c.h)", "```", "end"])
        mistakes.add.assert_called_once()
        self.assertEqual(mistakes.add.call_args[0][:2], ("01.md", 3))


if __name__ == "__main__":
    unittest.main()
