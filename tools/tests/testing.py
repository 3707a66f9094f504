"""Helpers of the tests of commands: the program, which is their first argument, and a folder."""

import fcntl
import functools
import os
import pathlib
import pty
import struct
import subprocess
import sys
import tempfile
import termios
import unittest

RUBRIC = str(pathlib.Path(sys.argv.pop(1)).resolve())
ROOT = pathlib.Path(__file__).resolve().parents[2]
FIRMWARE = pathlib.Path("spec/captures/firmware")  # Of the project's folder, where tests run.


def run(*words, env=None, **how):
    """Runs the program to its end; `text` says whether its output is text or bytes."""
    if "input" not in how:
        how = {"stdin": subprocess.DEVNULL, **how}
    how = {"capture_output": True, "check": False, "timeout": 300, **how}
    return subprocess.run([RUBRIC, *map(str, words)], env={**os.environ, **(env or {})}, **how)


def run_unread(*words):
    """Runs the program with a closed pipe as its stdout."""
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "wb") as out:
        return run(*words, capture_output=False, stdout=out, stderr=subprocess.PIPE)


@functools.cache
def sanitized():
    """Whether the program was built with sanitizers, which map terabytes without using them."""
    return b"__ubsan_handle" in pathlib.Path(RUBRIC).read_bytes()


def some(items):
    """All of them, but every fourth under sanitizers, where each takes ten times as long."""
    return list(items)[::4 if sanitized() else 1]


def rubric(*words, stdin="", **how):
    """Exit code, stdout and stderr as text."""
    data = stdin if isinstance(stdin, bytes) else stdin.encode()
    done = run(*words, input=data, **how)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


def on_terminal(*words, env, width=0):
    """Runs the program with a terminal as its stdout. Returns exit code and output."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
    environment = {k: v for k, v in os.environ.items() if k != "NO_COLOR"} | env
    with subprocess.Popen([RUBRIC, *map(str, words)], stdin=subprocess.DEVNULL, stdout=theirs,
                          env=environment) as process:
        os.close(theirs)
        out = b""
        try:
            while part := os.read(ours, 65536):
                out += part
        except OSError:
            pass  # The other end has closed.
    os.close(ours)
    return process.returncode, out


class ProgramTest(unittest.TestCase):
    """Tests of what the program says."""

    cwd = None  # The program runs there.

    def shows(self, words, *texts, code=0, err=None, **how):
        """The program ends with that exit code and shows these texts; among its errors is `err`,
        and there are none if that is empty. Returns its output."""
        got, out, said = rubric(*words, cwd=self.cwd, **how)
        self.assertEqual(got, code, (words, out, said))
        for text in texts:
            self.assertIn(text, out)
        if err is not None:
            self.assertIn(err, said if err else [said])
        return out

    def refused(self, words, says, code=64, **how):
        """The program ends with that exit code, without output, and says this among its errors."""
        got, out, err = rubric(*words, cwd=self.cwd, **how)
        self.assertEqual((got, out), (code, ""), (words, err))
        self.assertIn(says, err)


class Folder(ProgramTest):
    """Tests with a folder of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="rubric-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, content):
        """Returns the path of a new file of this text, or of these bytes, in the folder."""
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path
