#!/usr/bin/env python3
"""Each call that can fail fails once, at each place of what a command does.

No command may hang or crash, end with 0 without having done all, or lose a file or what it
confirmed. A place of malloc is a call stack, and it fails at the 1st, 4th, 16th ... call from
there. About 40 of these are tried of each session, and with --all all.
Usage: faults_test.py RUBRIC FAILING_CALLS [--all]
"""
import contextlib
import errno
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

import testing
from testing import FIRMWARE, RUBRIC

SHIM = sys.argv.pop(1)
ALL = sys.argv[1:] == ["--all"] and bool(sys.argv.pop())
CAPTURE = FIRMWARE / "a_join_data.pcapng"
CASES = "conformance/cases/j2.rtr"
OLD = b"an old file\n" * 100
PATIENCE_S = 30
# Every session writes @, which is there before. @lines are JSON lines, @other is a capture of
# another protocol, which decode finds out by itself, @spec has text of another encoding.
SESSIONS = (
    ("convert", CAPTURE, "-o", "@", "--format", "pcapng"),
    ("decode", CAPTURE, "--write", "@"),
    ("check", CAPTURE, "--format", "json", "--out", "@"),
    ("check", "--each", FIRMWARE, "--shard", "1/16", "--jobs", "1", "--out", "@"),
    ("generate", "--count", "20", "-o", "@"),
    ("simulate", "--seconds", "1", "--out-pcapng", "@"),
    ("test", CASES, "--target", "machine", "--format", "junit", "--out", "@"),
    ("test", CASES, "--target", "machine:answers_members", "--write-expect", "@"),
    ("chart", CASES, "--out", "@"),
    ("diff", CASES, "--target", "machine", "--target", "machine:answers_members", "--out", "@"),
    ("encode", "@lines", "--format", "pcapng", "--out", "@"),
    # By one thread, so that the same call fails each time.
    ("explore", "--motes", "1", "--calls", "1", "--loss", "--flaw", "no_fail", "--threads", "1",
     "--out", "@"),
    ("decode", "@other", "--write", "@"),
    ("encode", "@texts", "--spec", "@spec", "--as", "wide", "--carrier", "none", "--out", "@"),
)
FAILURES = {"open": errno.EMFILE, "read": errno.EIO, "write": errno.ENOSPC,
            "rename": errno.EIO, "fsync": errno.EIO, "malloc": errno.ENOMEM}


def timeless(text):
    """A report without the time that its run took, and without rates."""
    return re.sub(rb' time="[0-9.]+"|[0-9.]+ (s:|million)', b"", text)


def fnv(content):
    """The check sum of report.files: FNV-1a with 64 bits."""
    out = 0xcbf29ce484222325
    for byte in content:
        out = (out ^ byte) * 0x100000001b3 & (1 << 64) - 1
    return out


class Forwarder:
    """Greets every client, sends it some packets, waits for its end or leaves."""

    PACKETS = [bytes([0, 0xFF, 0xFF, 0, 0, 4, 0, 6, 0, 1, 2, n]) for n in range(5)]

    def __init__(self, test, leaves):
        self.leaves = leaves
        self.socket = socket.create_server(("127.0.0.1", 0))
        test.addCleanup(self.socket.close)
        self.name = "sf@127.0.0.1:{}".format(self.socket.getsockname()[1])
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                client, _ = self.socket.accept()
            except OSError:
                return
            threading.Thread(target=self.talk, args=(client,), daemon=True).start()

    def talk(self, client):
        with client:
            try:
                client.sendall(b"U ")
                client.recv(2, socket.MSG_WAITALL)
                for packet in self.PACKETS:
                    client.sendall(bytes([len(packet)]) + packet)
                while not self.leaves and client.recv(4096):
                    pass
            except OSError:
                pass


class Faults(testing.Folder):
    @classmethod
    def setUpClass(cls):
        inputs = pathlib.Path(tempfile.mkdtemp(prefix="rubric-faults-"))
        cls.addClassCleanup(shutil.rmtree, inputs)
        cls.inputs = {"@lines": inputs / "lines.jsonl", "@other": inputs / "other.pcapng",
                      "@texts": inputs / "texts.jsonl", "@spec": inputs / "wide.ksy"}
        cls.inputs["@texts"].write_text('{"text": "caf\u00e9"}\n', encoding="utf-8")
        cls.inputs["@spec"].write_text("meta: {id: wide, endian: be, encoding: UTF-16LE}\n"
                                       "seq: [{id: text, type: str, size-eos: true}]\n",
                                       encoding="utf-8")
        cls.inputs["@lines"].write_bytes(
            testing.run("decode", CAPTURE, "--format", "jsonl", "--count", "20").stdout)
        testing.run("generate", "--spec", "oscilloscope", "--count", "30", "--seed", "1",
                    "--format", "pcapng", "-o", cls.inputs["@other"])

    def setUp(self):
        super().setUp()
        self.old = self.folder / "old"
        self.count = self.folder / "count"

    def failing(self, call, at, failure):
        return dict(os.environ, LD_PRELOAD=SHIM, FAIL_CALL=call, FAIL_AT=str(at),
                    FAIL_ERRNO=str(failure), FAIL_COUNT=str(self.count))

    def named(self, words, old):
        places = {"@": old, **self.inputs}
        return [str(places.get(word, word)) for word in words]

    def run_with(self, words, call, at, failure=errno.EIO):
        return testing.run(*self.named(words, self.old), env=self.failing(call, at, failure),
                           timeout=PATIENCE_S)

    def places(self, words, call):
        """Returns the numbers of the calls that fail in turn, and what a good run does."""
        self.old.write_bytes(OLD)
        good = self.run_with(words, call, 0)
        self.assertIn(good.returncode, (0, 1, 3), (words, good.stderr))
        numbers = [int(line) for line in self.count.read_text().splitlines()[1:]]
        step = 1 if call != "malloc" or ALL else max(1, len(numbers) // 40)  # Spread over all.
        return numbers[::step], good, timeless(self.old.read_bytes())

    def one_by_one(self, words, call, numbers, failure):
        """Yields how the session ends where each of these calls fails, and what it wrote."""
        for number in numbers:
            self.old.write_bytes(OLD)
            done = self.run_with(words, call, number, failure)
            left = {path.name for path in self.folder.iterdir()} - {"count", "listed"}
            yield number, done, self.old.read_bytes(), left

    def in_copies(self, words, call, numbers, failure):
        """The same by copies of one process: starts are most of what the others take."""
        folder = self.folder / "of_copies"
        folder.mkdir()
        old, out, err = (folder / name for name in ("old", "out", "err"))
        old.write_bytes(OLD)
        listed = self.folder / "listed"
        listed.write_text("\n".join(map(str, numbers)))
        ours, theirs = socket.socketpair()
        with contextlib.ExitStack() as stack:
            stack.callback(shutil.rmtree, folder)
            environment = dict(self.failing(call, 0, failure), FAIL_FOLDER=str(folder),
                               FAIL_LIST=str(listed), FAIL_TALK=str(theirs.fileno()))
            with open(out, "wb") as to_out, open(err, "wb") as to_err:
                run = stack.enter_context(subprocess.Popen(
                    [RUBRIC, *self.named(words, old)], env=environment, stdout=to_out,
                    stderr=to_err, stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()]))
            stack.callback(run.kill)
            theirs.close()
            told = stack.enter_context(stack.enter_context(ours).makefile())
            for number in numbers:
                told_number, status = map(int, told.readline().split())
                self.assertEqual(told_number, number)
                code = os.waitstatus_to_exitcode(status)
                done = subprocess.CompletedProcess(words, code, out.read_bytes(), err.read_bytes())
                left = {path.name for path in folder.iterdir()} - {"out", "err"}
                yield number, done, old.read_bytes(), left
                ours.send(b"+")
            self.assertIn(run.wait(PATIENCE_S), (0, 1, 3))

    def fails_at_each_place(self, words, call, failure, tried):
        numbers, good, whole = self.places(words, call)
        # What --each starts is none of the process.
        how = self.in_copies if call == "malloc" and "--each" not in words else self.one_by_one
        for number, done, now, left in how(words, call, numbers, failure):
            what = (words[:2], call, number)
            tried[call] = tried.get(call, 0) + 1
            self.assertGreaterEqual(done.returncode, 0, (what, done.stderr))
            now = timeless(now)
            if b"the search ended early: more memory" in done.stdout:
                # What was found by then is told, and that it may not be all.
                self.assertEqual(done.returncode, good.returncode, what)
            elif done.returncode == good.returncode:
                # What failed was not needed, or was done in another way.
                self.assertEqual(timeless(done.stdout), timeless(good.stdout), what)
                if words[0] != "check" or now != whole:
                    self.assertEqual(len(now), len(whole), (what, done.stderr))
            else:
                self.assertNotEqual(done.returncode, 0, what)
                if "--each" in words and now != OLD:  # It tells of each run, or folder, what broke.
                    runs = 1 if f'"file":"{FIRMWARE}",'.encode() in now else whole.count(b"\n")
                    self.assertEqual(now.count(b"\n"), runs, what)
                else:
                    self.assertIn(now, (OLD, whole), (what, done.stderr))
                self.assertTrue(done.stderr or call == "malloc", what)
            self.assertEqual(left, {"old"}, what)

    def test_files(self):
        tried = {}
        for words in SESSIONS:
            for call, failure in FAILURES.items():
                with self.subTest(words=words, call=call):
                    self.fails_at_each_place(words, call, failure, tried)
        for call in FAILURES:
            self.assertGreater(tried[call], 5, call)

    def test_a_kill_leaves_old_or_whole_files(self):
        for words in SESSIONS:
            for call in ("open", "write", "rename", "fsync"):
                numbers, _, whole = self.places(words, call)
                for number in numbers:
                    self.old.write_bytes(OLD)
                    self.assertEqual(self.run_with(words, call, number, 0).returncode, -9, words)
                    self.assertIn(timeless(self.old.read_bytes()), (OLD, whole), (words, number))

    def test_reports_are_old_or_new(self):
        report = self.folder / "report"

        def tree():
            return {path.relative_to(report): path.read_bytes() for path in report.rglob("*")
                    if path.is_file()}

        words = ("check", CAPTURE, "--report", report)
        testing.run(*words)
        new = tree()
        for call in ("open", "write", "rename", "fsync"):
            numbers, good, _ = self.places(words, call)
            for number in numbers:
                shutil.rmtree(report)
                testing.run("check", FIRMWARE / "b_reliable.pcapng", "--report", report)
                old = tree()
                done = self.run_with(words, call, number, FAILURES[call])
                self.assertIn(tree(), (old, new), (call, number, done.stderr))
                if tree() == old:
                    self.assertNotEqual(done.returncode, good.returncode, (call, number))
        self.assertNotEqual(old, new)

    def test_a_report_that_a_kill_mixed_tells_so(self):
        """By its check sums."""
        report = self.folder / "report"

        def tree():
            return {str(path.relative_to(report)): path.read_bytes()
                    for path in report.rglob("*") if path.is_file()
                    and not path.relative_to(report).parts[0].startswith(".report.")}

        def sums_are_right(files):
            lines = files["report.files"].decode().splitlines()[1:]
            return all(fnv(files.get(path, b"")) == int(given, 16)
                       for given, path in (line.split(" ", 1) for line in lines))

        def begin_with_an_old_one():
            shutil.rmtree(report)
            testing.run("test", CASES, "--target", "machine:answers_members", "--report", report)

        words = ("test", CASES, "--target", "machine", "--report", report)
        testing.run(*words)
        new = tree()
        begin_with_an_old_one()
        mixed = 0
        for number in self.places(words, "rename")[0]:
            begin_with_an_old_one()
            old = tree()
            self.assertTrue(sums_are_right(old))
            self.assertEqual(self.run_with(words, "rename", number, 0).returncode, -9)
            now = tree()
            # What one of them has alone is listed by none before it is there, or until it is gone.
            replaced = {now[path] != old[path] for path in {*old} & {*new} - {"report.files"}
                        if timeless(old[path]) != timeless(new[path])}
            if len(replaced) < 2:
                continue
            mixed += 1
            self.assertFalse(sums_are_right(now), number)
            self.assertTrue(list(report.glob(".report.*")), number)
            testing.run(*words)
            self.assertTrue(sums_are_right(tree()), number)
        self.assertGreater(mixed, 2)

    def test_what_a_line_sends(self):
        words = ("decode", Forwarder(self, True).name, "--format", "jsonl", "--time", "none",
                 "--count", len(Forwarder.PACKETS), "--write", self.folder / "kept", "--force")
        for call, failure in {**FAILURES, "connect": errno.ECONNREFUSED}.items():
            numbers, good, _ = self.places(words, call)
            self.assertEqual(len(good.stdout.splitlines()), len(Forwarder.PACKETS), good.stderr)
            for number in numbers:
                done = self.run_with(words, call, number, failure)
                what = (call, number, done.stderr)
                self.assertGreaterEqual(done.returncode, 0, what)
                self.assertTrue(good.stdout.startswith(done.stdout), what)
                if done.returncode == good.returncode:
                    self.assertEqual(done.stdout, good.stdout, what)
                else:
                    self.assertNotEqual(done.returncode, 0, what)
                    self.assertTrue(done.stderr, what)

    def test_who_comes_is_served(self):
        source = Forwarder(self, False)
        for failure in (errno.EMFILE, errno.ECONNABORTED):
            child = subprocess.Popen([RUBRIC, "forward", source.name, "--port", "0"],
                                     env=self.failing("accept", 1, failure), text=True,
                                     stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
            try:
                port = int(re.search(r":(\d+)$", child.stdout.readline())[1])
                with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as client:
                    client.sendall(b"U ")
                    self.assertEqual(client.recv(2, socket.MSG_WAITALL), b"U ")
            finally:
                child.terminate()
                child.wait(PATIENCE_S)
                child.stdout.close()
            self.assertEqual(int(self.count.read_text()) > 1, True)


if __name__ == "__main__":
    unittest.main()
