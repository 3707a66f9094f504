#!/usr/bin/env python3
"""The example of README.md runs, agrees, and finds a fault that is planted in the decoder.

Usage: external_test.py RUBRIC [TestClass ...], in the project's folder.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest

HERE = pathlib.Path(__file__).resolve().parent
RUBRIC = None
KAITAI_CHECK = "spec/kaitai_check"  # Where npm put Kaitai Struct.


def compare(*arguments, code):
    done = subprocess.run([sys.executable, str(HERE / "compare.py"), "--rubric", RUBRIC,
                           *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == code, (done.returncode, done.stdout[-3000:], done.stderr[-3000:])
    return done.stdout


class Scratch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="rubric-external-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def patched(self, source, old, new):
        """A copy of a file with one place changed."""
        text = pathlib.Path(source).read_text("utf-8")
        self.assertIn(old, text)
        target = self.folder / pathlib.Path(source).name
        target.write_text(text.replace(old, new), "utf-8")
        return target

    def assert_names(self, said, *words):
        for word in words:
            self.assertIn(word, said)


class Kaitai(Scratch):
    def kaitai(self, specs, code, *arguments):
        return compare("--count", "10000", *arguments, "--", "node",
                       str(HERE / "kaitai_decoder.js"), str(specs), KAITAI_CHECK, code=code)

    def test_agrees(self):
        said = self.kaitai("spec/wire", 0)
        self.assert_names(said, "10000 frames: ", " 0 skipped, 0 disagreements")

    def planted(self, old, new):
        shutil.copy("spec/wire/tinyos.ksy", self.folder)
        self.patched("spec/wire/rubicon.ksy", old, new)
        return self.kaitai(self.folder, 1)

    def test_a_bound_one_too_large_is_found(self):
        said = self.planted("max: 102", "max: 103")
        self.assert_names(said, "net_msg.nbytes: expected a number from 2 to 102, given 103",
                          "rubric explain WIRE-NET-NBYTES",
                          "should have been refused, out_of_range", "was accepted")

    def test_a_bound_one_too_small_is_found(self):
        said = self.planted("max: 102", "max: 101")
        self.assert_names(said, "should have been accepted as net_msg", "was refused: Validation")

    def test_swapped_fields_are_found(self):
        """Nothing is refused or accepted wrongly then; the fields show it."""
        net_msg = "      - id: seq_num\n        type: u2\n        doc: Sequence number.\n"
        said = self.planted(net_msg, net_msg.replace("u2", "u2le"))
        self.assert_names(said, "net_msg.seq_num should have been")


class Harness(Scratch):
    """Decoders of which the harness alone is tried."""

    def decoder(self, code, body, *arguments):
        script = self.folder / "decoder.py"
        script.write_text("import json, sys\n" + textwrap.dedent(body), "utf-8")
        return compare("--count", "300", *arguments, "--", sys.executable,
                       str(script), code=code)

    def test_accepting_everything_is_wrong(self):
        said = self.decoder(1, """
            for line in sys.stdin:
                print(json.dumps({"accept": True}))
        """)
        self.assert_names(said, "was accepted")
        self.assertNotIn("was refused", said)

    def test_skipping_everything_says_nothing(self):
        said = self.decoder(1, """
            for line in sys.stdin:
                print(json.dumps({"skip": True}))
        """)
        self.assert_names(said, "300 skipped", "Too little was compared")

    def test_an_early_end_is_reported(self):
        said = self.decoder(1, """
            print(json.dumps({"skip": True}))
        """)
        self.assert_names(said, "frame 2, ", "no answer came")

    def test_what_is_not_an_answer_is_reported(self):
        said = self.decoder(1, """
            for line in sys.stdin:
                print("yes")
        """)
        self.assert_names(said, "the answer is not a JSON object: yes")
        said = self.decoder(1, """
            for line in sys.stdin:
                print(json.dumps({"accept": "yes"}))
        """)
        self.assert_names(said, 'the answer was {"accept": "yes"}')

    def test_a_program_that_is_not_there(self):
        compare("--count", "10", "--", str(self.folder / "none"), code=2)


if __name__ == "__main__":
    RUBRIC = sys.argv.pop(1)
    unittest.main()
