#!/usr/bin/env python3
"""A wire spec with fields in another order, and everything that reads or writes frames follows it.

Usage: swapped_fields_test.py RUBRIC RUBRICC BUILD_FOLDER PROJECT_FOLDER. Needs tshark.

Fields of two messages change places in a copy of the spec; the copy is generated and built anew.
Whoever still knows where a field was reads another one there: `decode`, `check`, the simulator, the
reference machine, the vectors and Wireshark's dissector must agree with each other, and must say of
the new bytes what the sound program says of the old ones.
"""

import collections
import importlib.util
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

RUBRIC = RUBRICC = BUILD = ROOT = pathlib.Path()
# A message, and two of its fields, one right after the other.
SWAPS = {"join_reply": ("cur_time", "seq_num"), "net_msg": ("dest", "src")}
# In the bytes of a vector: the message, where the first field begins, and the sizes of both.
MOVED = {"join_reply": (4, 4, 2), "net_msg": (0, 4, 4)}
TARGETS = ["rubric", "codec_vectors_test", "check_one_reader_test"]


def run(*words, cwd, codes=(0,)):
    done = subprocess.run([str(word) for word in words], cwd=cwd, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    text = done.stdout.decode(errors="replace")
    if done.returncode not in codes:
        raise AssertionError(f"{words} ended with {done.returncode}:\n{text[-8000:]}")
    return text


def with_swapped_fields(spec, message, first, second):
    """The text of the spec with two neighbours in the list of the message's fields exchanged."""
    begin = spec.index(f"\n  {message}:\n")
    end = re.compile(r"\n  \w").search(spec, begin + 3)
    text = spec[begin:end.start() + 1 if end else len(spec)]
    field = r"      - id: {}\n(?:        .*\n)+"
    pair = re.compile(f"({field.format(first)})({field.format(second)})")
    swapped, count = pair.subn(r"\2\1", text)
    if count != 1:
        raise AssertionError(f"{message} does not have {first} before {second}")
    return spec.replace(text, swapped)


def with_moved_bytes(vector, at, first, second):
    """A vector, whose bytes were laid out by the spec as it was."""
    found = re.search(r'(?m)^bytes: (?:"(.*)"|>-\n((?:  .*\n?)+))', vector)
    data = bytes.fromhex(found[1] if found[2] is None else found[2].replace("\n", " "))
    if len(data) < at + first + second:
        return vector  # Cut short: all its fields are bytes of some kind.
    middle = at + first
    data = data[:at] + data[middle:middle + second] + data[at:middle] + data[middle + second:]
    end = "" if found[2] is None else "\n"
    return vector.replace(found[0], f'bytes: "{data.hex(" ")}"{end}')


class SwappedFields(unittest.TestCase):
    maxDiff = 3000

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="rubric-swapped-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.work = pathlib.Path(cls.folder.name)
        cls.copy = cls.work / "project"
        files = run("git", "ls-files", "-co", "--exclude-standard", cwd=ROOT).splitlines()
        for name in files:
            if (ROOT / name).is_file():
                (cls.copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, cls.copy / name)
        cls.generate()
        cls.build()

    @classmethod
    def generate(cls):
        path = cls.copy / "spec/wire/rubicon.ksy"
        spec = path.read_text(encoding="utf-8")
        for message, fields in SWAPS.items():
            spec = with_swapped_fields(spec, message, *fields)
            for vector in (cls.copy / "spec/vectors/rubicon" / message).glob("*.yaml"):
                text = vector.read_text(encoding="utf-8")
                vector.write_text(with_moved_bytes(text, *MOVED[message]), encoding="utf-8")
        path.write_text(spec, encoding="utf-8")
        emitters = re.search(r"set\(emitters (\S+)\)",
                             (ROOT / "spec/compiler/CMakeLists.txt").read_text(encoding="utf-8"))
        specs = sorted(str(one.relative_to(cls.copy)) for one in path.parent.glob("*.ksy"))
        run(RUBRICC, "--emit", emitters[1], "--out", cls.copy, *specs, cwd=cls.copy)

    @classmethod
    def build(cls):
        """As little as it takes, in as little time."""
        out = cls.work / "build"
        known = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
        names = r"CXX_COMPILER(?:_LAUNCHER)?|PREFIX_PATH|UNITY_BUILD\w*"
        words = re.findall(rf"^(CMAKE_(?:{names})):\w+=(.+)$", known, re.M)
        run("cmake", "-S", cls.copy, "-B", out, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
            "-DCMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG", "-DRUBRIC_TESTS=ON", "-DRUBRIC_BENCH=OFF",
            *(f"-D{name}={value}" for name, value in words), cwd=cls.work)
        run("cmake", "--build", out, "--target", *TARGETS, cwd=cls.work)
        cls.swapped = out / "rubric"
        cls.tests = {name: next(out.rglob(name)) for name in TARGETS[1:]}

    def decoded(self, rubric, path):
        # 1: there are malformed frames.
        text = run(rubric, "decode", path, "--format", "jsonl", cwd=self.copy, codes=(0, 1))
        return [json.loads(line) for line in text.splitlines()]

    def checked(self, rubric, path, *more):
        done = subprocess.run([rubric, "check", path, "--format", "json", *more], cwd=self.copy,
                              stdout=subprocess.PIPE, check=False)
        report = json.loads(done.stdout)
        return json.dumps(report).replace(str(path), "FILE")

    def both(self, name):
        """Paths of a capture as the sound and as the swapped spec lay it out."""
        return [(RUBRIC, self.work / f"{name}.sound.pcapng"),
                (self.swapped, self.work / f"{name}.swapped.pcapng")]

    def compare(self, name, *options):
        """Two captures of the same frames: the same fields in other bytes, the same judgement."""
        (sound, before), (swapped, after) = self.both(name)
        was, now = self.decoded(sound, before), self.decoded(swapped, after)
        self.assertEqual(len(was), len(now))
        moved = 0
        for one, other in zip(was, now):
            # The bytes are others, and so are their sums.
            hexes = [record.pop("raw") for record in (one, other)]
            for record in (one, other):
                record["frame"].pop("crc", None)
                record["frame"].pop("fcs", None)
            self.assertEqual(one, other)
            moved += hexes[0] != hexes[1]
        verdict = self.checked(sound, before, *options)
        self.assertEqual(verdict, self.checked(swapped, after, *options))
        return moved, verdict

    def test_decode_and_check_read_the_same(self):
        """The comparison of both readers, over captures, corpora and generated frames."""
        print(run(self.tests["check_one_reader_test"], cwd=self.copy), file=sys.stderr)

    def test_vectors(self):
        run(self.tests["codec_vectors_test"], cwd=self.copy)
        # They can fail: the copy's program on the bytes as they were.
        with self.assertRaises(AssertionError):
            run(self.tests["codec_vectors_test"], cwd=ROOT)

    def test_simulated_network(self):
        """A run of reference machines is the same run in other bytes, and check passes it."""
        for rubric, path in self.both("network"):
            run(rubric, "simulate", "--motes", "4", "--seconds", "20", "--out-pcapng", path,
                cwd=self.copy)
        (sound, before), (swapped, after) = self.both("network")

        def messages(rubric, path):
            """Without times: a serial line takes longer for bytes that have to be escaped."""
            return collections.Counter(
                json.dumps([record["interface"], record["path"], record["fields"]],
                           sort_keys=True)
                for record in self.decoded(rubric, path) if record["message"] != "join_reply")
        self.assertEqual(messages(sound, before), messages(swapped, after))
        options = ("--sniffer", "complete", "--start", "cold")
        counts = [json.loads(self.checked(*one, *options))["counts"]
                  for one in ((sound, before), (swapped, after), (sound, after))]
        self.assertEqual(counts[0], counts[1])
        self.assertEqual(counts[0]["fail"], 0)
        self.assertGreater(counts[0]["frames"], 100)
        # By the layout of the other one nothing is right: the order of fields does matter.
        self.assertGreater(counts[2]["fail"], 0)

    def test_captures_of_the_firmware(self):
        """Their frames, encoded anew by each spec, with all that check finds in them."""
        moved = 0
        verdicts = ""
        for capture in sorted((ROOT / "spec/captures/firmware").glob("*.pcapng")):
            lines = self.work / "lines.jsonl"
            with open(lines, "w", encoding="utf-8") as file:
                for record in self.decoded(RUBRIC, capture):
                    if record["error"] is None and record["fields"] is not None:
                        for key in ("raw", "crc", "fcs"):
                            record.pop(key, None)
                            record["frame"].pop(key, None)
                        file.write(json.dumps(record) + "\n")
            for rubric, path in self.both(capture.stem):
                run(rubric, "encode", lines, "--format", "pcapng", "-o", path, cwd=self.copy)
            with self.subTest(capture.name):
                more, verdict = self.compare(capture.stem, "--sniffer", "complete")
                moved += more
                verdicts += verdict
        self.assertGreater(moved, 400)
        for rule in ("J3-TIME", "N6-CONTENT"):  # These are no empty reports.
            self.assertIn(f'{{"requirement": "{rule}", "level"', verdicts)

    def test_reference_machine_passes_the_golden_traces(self):
        """But for cases whose net_msg is written as bytes."""
        out = run(self.swapped, "test", "--target", "machine", cwd=self.copy, codes=(1,))
        cases = {}
        for file in (ROOT / "conformance/cases").rglob("*.rtr"):
            for text in re.split(r"(?m)^case ", file.read_text(encoding="utf-8"))[1:]:
                cases[text.split(None, 1)[0]] = text
        for case in re.findall(r"^fail +(\S+)", out, re.M):
            self.assertIn("am(type=net payload=x", cases[case], case)
        self.assertGreater(len(re.findall(r"^pass ", out, re.M)), 200)

    def test_wireshark(self):
        """Each field of generated frames, and of the network above, against `rubric decode`."""
        place = next(self.copy.rglob("wireshark_test.py"))
        module = importlib.util.module_from_spec(
            importlib.util.spec_from_file_location("wireshark_test", place))
        sys.argv.insert(1, str(self.swapped))  # As the first argument of a test of commands.
        sys.path.insert(0, str(place.parents[1]))
        module.__spec__.loader.exec_module(module)
        suite = unittest.TestSuite(module.Dissector(name) for name in (
            "test_generated_serial_frames", "test_generated_radio_frames"))
        result = unittest.TestResult()
        suite.run(result)
        self.assertEqual(result.testsRun, 2)
        self.assertTrue(result.wasSuccessful(), result.failures + result.errors)
        path = self.work / "air.pcapng"
        run(self.swapped, "simulate", "--seed", "5", "--out-pcapng", path, cwd=self.copy)
        self.assertGreater(module.Dissector("compare_one").compare(path), 400)


if __name__ == "__main__":
    ROOT, BUILD, RUBRICC, RUBRIC = (pathlib.Path(sys.argv.pop()).resolve() for _ in range(4))
    if shutil.which("tshark") is None:
        sys.exit("swapped_fields_test.py: tshark is missing")
    os.environ.pop("RUBRIC_ROOT", None)
    unittest.main()
