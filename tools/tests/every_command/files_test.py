#!/usr/bin/env python3
"""Files that commands write: old ones stay whole, new ones are whole or absent.

Usage: files_test.py RUBRIC
"""
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

from live_testing import Forwarder
from testing import RUBRIC, ROOT, Folder, run, run_unread

FIRMWARE = ROOT / "spec/captures/firmware"
CAPTURE = FIRMWARE / "a_join_data.pcapng"
SERIAL = FIRMWARE / "a_join_data.serial.bin"
OLD = b"an old file\n" * 100
USAGE, OUTPUT = 64, 74
PATIENCE_S = 60
CASES = ROOT / "conformance/cases/j2.rtr"  # To read all that ship takes ten times as long.
CASE = CASES.read_text()

# Every command that writes a file, which is @.
WRITERS = (
    ("convert", CAPTURE, "-o", "@", "--format", "pcapng"),
    ("decode", CAPTURE, "--write", "@"),
    ("check", CAPTURE, "--out", "@"),
    ("check", CAPTURE, "--format", "jsonl", "--out", "@"),
    ("check", "--each", CAPTURE, "--out", "@"),
    ("generate", "--count", "40", "-o", "@"),
    ("generate", "--count", "40", "--format", "hex", "-o", os.devnull, "--expect", "@"),
    ("simulate", "--seconds", "1", "--out-rtr", "@"),
    ("simulate", "--seconds", "1", "--out-pcapng", "@"),
    ("chart", f"{CASES}:j2.listed", "--out", "@"),
    ("shrink", ROOT / "conformance/cases/j4.rtr", "--target", "machine:acks_wrong_seq", "--out",
     "@"),
    ("repro", "machine", SERIAL, "--out", "@"),
    ("explore", "--motes", "1", "--calls", "1", "--loss", "--flaw", "no_fail", "--out", "@"),
    ("test", CASES, "--target", "machine", "--out", "@"),
    ("test", CASES, "--target", "machine", "--format", "json", "--out", "@"),
    ("test", CASES, "--target", "machine:answers_members", "--write-expect", "@"),
    ("diff", CASES, "--target", "machine", "--target", "machine:answers_members", "--out", "@"),
)


def full_disk(size):
    """Returns what makes writing more than `size` bytes of a file fail."""
    def fill():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return fill


def written(words, path):
    return [path if word == "@" else word for word in words]


class Files(Folder):
    def setUp(self):
        super().setUp()
        self.old = self.folder / "old.pcapng"
        self.old.write_bytes(OLD)

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def assert_untouched(self, words):
        self.assertEqual(self.names(), ["old.pcapng"], words)
        self.assertEqual(self.old.read_bytes(), OLD, words)

    def test_a_file_is_replaced_whole(self):
        self.old.chmod(0o640)
        for words in WRITERS:
            done = run(*written(words, self.old))
            self.assertIn(done.returncode, (0, 1), (words, done.stderr))
            self.assertEqual(self.names(), ["old.pcapng"], words)
            self.assertNotIn(OLD, self.old.read_bytes(), words)
            self.assertEqual(self.old.stat().st_mode & 0o777, 0o640, words)
            self.old.write_bytes(OLD)

    def test_a_link_stays_a_link(self):
        (self.folder / "to_old").symlink_to("old.pcapng")
        (self.folder / "to_nothing").symlink_to("nothing")
        (self.folder / "to_link").symlink_to("to_nothing")
        for name, real in (("to_old", "old.pcapng"), ("to_link", "nothing")):
            done = run("decode", CAPTURE, "--write", self.folder / name)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.folder / name).is_symlink())
            self.assertFalse((self.folder / real).is_symlink())
            self.assertEqual(run("stats", self.folder / real).returncode, 0)
        self.assertTrue((self.folder / "to_nothing").is_symlink())

    def test_a_full_disk(self):
        for words in WRITERS:
            for size in (0, 100):
                for path in (self.old, self.folder / "new"):
                    done = run(*written(words, path), preexec_fn=full_disk(size))
                    self.assertEqual(done.returncode, OUTPUT, (words, done.stderr))
                    self.assertIn(b"File too large", done.stderr, words)
                    self.assert_untouched(words)
            self.assertEqual(run(*written(words, "/dev/full")).returncode, OUTPUT, words)

    def test_a_folder_that_is_gone(self):
        for words in WRITERS:
            done = run(*written(words, self.folder / "no" / "x"))
            self.assertEqual(done.returncode, OUTPUT, (words, done.stderr))
            self.assertIn(b"No such file or directory", done.stderr, words)

    def test_a_folder_that_vanishes(self):
        gone = self.folder / "gone"
        gone.mkdir()
        with self.feeding("convert", "-", "-o", gone / "x.pcapng") as process:
            self.feed(process, gone, SERIAL.read_bytes()[:5000])
            shutil.rmtree(gone)
            process.stdin.close()
            self.assertIn(b"No such file or directory", process.stderr.read())
            self.assertEqual(process.wait(PATIENCE_S), OUTPUT)
        self.assert_untouched("convert")

    def test_a_growing_file_that_is_deleted(self):
        kept = self.folder / "kept.pcapng"
        with self.feeding("decode", "--format", "jsonl", "--write", kept) as process:
            process.stdin.write(SERIAL.read_bytes()[:2000])
            process.stdin.flush()
            process.stdout.readline()
            kept.unlink()
            process.stdin.close()
            process.stdout.read()
            self.assertIn(b"No such file or directory", process.stderr.read())
            self.assertEqual(process.wait(PATIENCE_S), OUTPUT)

    def test_findings_that_find_no_folder(self):
        done = run("check", "-", "--follow", "--format", "jsonl", "--out", self.folder / "no" / "x",
                   input=SERIAL.read_bytes(), timeout=PATIENCE_S)
        self.assertEqual(done.returncode, OUTPUT, done.stderr)
        self.assertIn(b"cannot write", done.stderr)

    def test_folders_of_new_files_are_whole_or_empty(self):
        for words in (("new-adapter", "python", "--out"), ("new-protocol", "probes", "--out")):
            folder = self.folder / words[0]
            done = run(*words, folder, preexec_fn=full_disk(2000))
            self.assertEqual(done.returncode, OUTPUT, done.stderr)
            self.assertEqual([path for path in folder.rglob("*") if path.is_file()], [])
            self.assertEqual(run(*words, folder).returncode, 0)

    def test_each_command_killed_at_any_point(self):
        """Of each command: the old file stays, or the new one is whole."""
        for words in WRITERS:
            done = run(*written(words, self.old))
            whole = len(self.old.read_bytes())
            self.assertIn(done.returncode, (0, 1), words)
            for part in range(6):
                self.old.write_bytes(OLD)
                process = subprocess.Popen([RUBRIC, *map(str, written(words, self.old))],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(0.004 * part)
                process.kill()
                process.wait(PATIENCE_S)
                now = self.old.read_bytes()
                # Reports say how long their run took.
                self.assertTrue(now == OLD or abs(len(now) - whole) < 40, (words, len(now), whole))
                for path in self.folder.glob(".old.pcapng.*"):  # What a kill leaves beside it.
                    path.unlink()
                self.assertEqual(self.names(), ["old.pcapng"], words)

    def test_a_closed_pipe(self):
        for words in (("decode", CAPTURE), ("check", CAPTURE), ("stats", CAPTURE),
                      ("explain", "J4"), ("messages",), ("completion", "bash"), ("coverage",),
                      ("generate", "--count", "9"), ("convert", CAPTURE, "--format", "hex"),
                      ("test", "--list"), ("chart", "j4.accept"),
                      ("simulate", "--seconds", "1")):
            done = run_unread(*words)
            self.assertEqual(done.returncode, OUTPUT, (words, done.stderr))
            self.assertNotIn(b"cannot write", done.stderr, words)

    def test_an_input_is_no_output(self):
        capture = self.folder / "x.pcapng"
        trace = self.folder / "x.rtr"
        (self.folder / "link").symlink_to("x.pcapng")
        for name in ("x.pcapng", "link", "hard"):
            output = self.folder / name
            capture.write_bytes(CAPTURE.read_bytes())
            if name == "hard":
                os.link(capture, output)
            for words in (("decode", capture, "--write", output, "--force"),
                          ("convert", capture, output, "--format", "pcapng"),
                          ("check", capture, "--out", output),
                          ("check", capture, "sf@127.0.0.1:1", "--write", output, "--force"),
                          ("check", capture, "--follow", "--out", output)):
                done = run(*words)
                self.assertEqual(done.returncode, USAGE, (words, done.stderr))
                self.assertIn(b"is also an input", done.stderr, words)
                self.assertEqual(capture.read_bytes(), CAPTURE.read_bytes(), words)
        known = self.folder / "known.yaml"
        known.write_text("- requirement: J3-TIME\n  message: cur_time\n  reason: known\n")
        spec = self.folder / "x.ksy"
        shutil.copy(FIRMWARE.parents[1] / "wire/rubicon.ksy", spec)
        for read, words in ((known, ("check", CAPTURE, "--expect", known, "--out", known)),
                            (known, ("check", CAPTURE, "--follow", "--expect", known, "--out",
                                     known)),
                            (known, ("check", "--each", CAPTURE, "--expect", known, "--out",
                                     known)),
                            (known, ("check", "--each", CAPTURE, "--resume", known, "--out",
                                     known)),
                            (spec, ("decode", CAPTURE, "--spec", spec, "--write", spec)),
                            (spec, ("encode", "--spec", spec, "--out", spec)),
                            (spec, ("generate", "--spec", spec, "-o", spec, "--count", "3"))):
            before = read.read_bytes()
            self.assertIn(b"is also an input", run(*words).stderr, words)
            self.assertEqual(read.read_bytes(), before, words)
        trace.write_text(CASE)
        for words in (("test", trace, "--target", "machine", "--out", trace),
                      ("test", trace, "--target", "machine", "--write-expect", trace),
                      ("shrink", trace, "--target", "machine", "--out", trace),
                      ("chart", f"{trace}:j2.listed", "--out", trace),
                      ("repro", "machine", trace, "--out", trace),
                      ("simulate", "--out-rtr", trace, "--out-pcapng", trace)):
            self.assertIn(b"is also an input", run(*words).stderr, words)
            self.assertEqual(trace.read_text(), CASE, words)

    def test_a_report_replaces_no_input(self):
        (self.folder / "cases/machine").mkdir(parents=True)
        for name, content, words in (
                ("report.json", CAPTURE.read_bytes(), ("check",)),
                ("report.tap", CASE.encode(), ("test", "--target", "machine")),
                ("report.files", CAPTURE.read_bytes(), ("check",)),
                ("cases/machine/j2.rtr", CASE.encode(), ("test", "--target", "machine"))):
            read = self.folder / name
            read.write_bytes(content)
            done = run(*words, read, "--report", self.folder)
            self.assertEqual(done.returncode, 64, (name, done.stderr))
            self.assertIn(b"--report", done.stderr, name)
            self.assertEqual(read.read_bytes(), content, name)
        out = self.folder / "new/index.html"
        done = run("check", CAPTURE, "--report", out.parent, "--out", out)
        self.assertEqual(done.returncode, 64, done.stderr)

    def line(self):
        """A forwarder of one packet."""
        forwarder = Forwarder(self)
        packet = bytes([0, 0xFF, 0xFF, 0, 0, 4, 0, 6, 0, 1, 2, 3])
        threading.Thread(target=lambda: forwarder.accept(bytes([len(packet)]) + packet).close(),
                         daemon=True).start()
        return f"sf@127.0.0.1:{forwarder.port}"

    def test_a_source_that_cannot_be_had_costs_no_file(self):
        for source in ("sf@127.0.0.1:1", "serial@/nonexistent:telosb", "/nonexistent", "/"):
            for words in (("decode", source, "--force", "--write"),
                          ("check", source, "--force", "--follow", "--write"),
                          ("forward", source, "--port", "0", "--force", "--write"),
                          ("convert", source, "-o"), ("encode", source, "-o"),
                          ("decode", CAPTURE, source, "--force", "--write"),
                          ("convert", CAPTURE, source, "-o"),
                          ("check", CAPTURE, self.line(), source, "--force", "--write")):
                for target in (self.old, self.folder / "new.pcapng"):
                    done = run(*words, target)
                    self.assertNotIn(done.returncode, (0, 1), words)
                    self.assert_untouched(words)

    def feeding(self, *words):
        return subprocess.Popen([RUBRIC, *map(str, words)], stdin=subprocess.PIPE,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    @staticmethod
    def feed(process, folder, data, name=".x.pcapng."):
        """Feeds it, and waits until it has opened its output."""
        process.stdin.write(data)
        process.stdin.flush()
        while not any(path.name.startswith(name) for path in folder.iterdir()):
            assert process.poll() is None, process.stderr.read()
            time.sleep(0.01)

    def test_killed_at_any_point(self):
        data = SERIAL.read_bytes()
        for size in (40, 1000, len(data) - 1, len(data)):
            with self.feeding("convert", "-", "-o", self.old, "--format", "pcapng") as process:
                self.feed(process, self.folder, data[:size], ".old.pcapng.")
                process.kill()
            self.assertEqual(self.old.read_bytes(), OLD, size)
            for path in self.folder.glob(".old.pcapng.*"):  # What a kill leaves beside it.
                path.unlink()

    def test_a_growing_capture_has_what_was_shown(self):
        kept = self.folder / "kept.pcapng"
        data = SERIAL.read_bytes()
        with self.feeding("decode", "--format", "jsonl", "--write", kept) as process:
            process.stdin.write(data[:2000])
            process.stdin.flush()
            shown = [process.stdout.readline() for _ in range(10)]
            process.kill()
        self.assertTrue(shown[-1])
        frames = run("decode", kept, "--format", "jsonl").stdout.splitlines()
        self.assertGreaterEqual(len(frames), len(shown))

    def test_a_growing_capture_replaces_no_file(self):
        data = SERIAL.read_bytes()
        done = run("decode", "--write", self.old, input=data)
        self.assertEqual(done.returncode, USAGE)
        self.assertIn(b"exists; --force replaces it", done.stderr)
        self.assert_untouched("decode")
        done = run("decode", "--write", self.old, "--force", input=data)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = run("decode", SERIAL).stdout.splitlines()
        self.assertEqual(len(run("decode", self.old).stdout.splitlines()), len(whole))

    def test_rotation(self):
        data = SERIAL.read_bytes()
        (self.folder / "run.3.pcapng").write_bytes(OLD)
        kept = self.folder / "run.pcapng"
        done = run("decode", "--write", kept, "--rotate", "2k", input=data)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "run.3.pcapng").read_bytes(), OLD)
        parts = [path for path in [kept] + [self.folder / f"run.{i}.pcapng" for i in range(2, 99)]
                 if path.exists() and path.name != "run.3.pcapng"]
        self.assertGreater(len(parts), 3)
        fields = ("--fields", "message,raw", "--format", "csv")
        self.assertEqual(run("decode", *parts, *fields).stdout,
                         run("decode", SERIAL, *fields).stdout)
        for part in parts[:-1]:
            self.assertTrue(2048 <= part.stat().st_size < 3072, part)
        for text in ("", "0k", "5", "-1k", "5m", "k"):
            done = run("decode", SERIAL, "--write", self.folder / "y", "--rotate", text)
            self.assertEqual(done.returncode, USAGE, text)

    def test_rotation_by_time(self):
        data = SERIAL.read_bytes()
        kept = self.folder / "run.pcapng"
        with self.feeding("decode", "--format", "jsonl", "--write", kept,
                          "--rotate", "1s") as process:
            process.stdin.write(data[:2000])
            process.stdin.flush()
            process.stdout.readline()  # It is open.
            time.sleep(1.1)
            process.stdin.write(data[2000:])
            process.stdin.close()
            process.stdout.read()
        self.assertEqual(process.returncode, 0)
        second = self.folder / "run.2.pcapng"
        counts = [len(run("decode", path).stdout.splitlines()) for path in (kept, second)]
        self.assertGreater(min(counts), 3)
        self.assertEqual(len(run("decode", SERIAL).stdout.splitlines()), sum(counts))

    def test_a_report_is_written_as_one(self):
        report = self.folder / "report"
        words = ("test", "--target", "machine", "--report", report, "--cases")
        self.assertEqual(run(*words, "j2.*").returncode, 0)
        tree = {path: path.read_bytes() for path in report.rglob("*") if path.is_file()}
        for size in (0, 1000, 20000):
            done = run(*words, "j4.*", preexec_fn=full_disk(size))
            self.assertEqual(done.returncode, OUTPUT, done.stderr)
            self.assertEqual({path: path.read_bytes() for path in report.rglob("*")
                              if path.is_file()}, tree)

    def test_a_run_that_broke_keeps_the_report(self):
        done = run("test", "--target", "/nonexistent/adapter", "--format", "json",
                   "--out", self.old)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"stays as it was", done.stderr)
        self.assert_untouched("test")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
