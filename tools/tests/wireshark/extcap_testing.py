"""Helpers of the tests of rubric-extcap: sources on this host, and programs to be ended."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from serial_testing import PATIENCE_S
from testing import ROOT, RUBRIC

EXTCAP = os.path.abspath(sys.argv.pop(1))  # After RUBRIC, which testing.py takes.
SERIAL = ROOT / "spec/captures/firmware/a_join_data.serial.bin"
FORWARDER = ROOT / "spec/captures/basestation/s04_acks.from_sink.sfstream"
PACKET = bytes.fromhex("00ffff000003002514000c")  # A config message.


def run(*words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          check=False, timeout=PATIENCE_S, **more)


def decoded(path):
    out = run(RUBRIC, "decode", path, "--format", "jsonl").stdout
    return [json.loads(line) for line in out.splitlines()]


def meaning(records):
    return [(record["path"], record["fields"], record["error"]) for record in records]


class Base(unittest.TestCase):
    maxDiff = 3000

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="rubric extcap ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.home = self.folder / "home"
        self.home.mkdir()
        self.environment = {name: value for name, value in os.environ.items()
                            if name not in ("MOTECOM", "XDG_CONFIG_HOME")}
        self.environment.update(HOME=str(self.home), TMPDIR=str(self.folder))

    def started(self, *words):
        process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env=self.environment,
                                   start_new_session=True)

        def end():
            process.kill()
            process.wait()
            process.stdout.close()
            process.stderr.close()
        self.addCleanup(end)
        return process

    def ended(self, process):
        """Its exit code and what it said on stderr."""
        err = process.communicate(timeout=PATIENCE_S)[1].decode()
        return process.returncode, err
