"""Helpers of the tests of `rubric test`: the program, and implementations that misbehave."""

import os
import pathlib
import time

from testing import Folder as AnyFolder, rubric

MOTE = pathlib.Path("conformance/adapters/python")
HONEST = f"python3 {MOTE}/adapter.py"
CASES = sum(line.startswith("case ") for path in pathlib.Path("conformance/cases").rglob("*.rtr")
            for line in path.read_text().splitlines())

# An adapter that does nothing, and breaks as its first argument says.
FAKE = '''
import os, signal, sys, time
how = sys.argv[1]
for line in sys.stdin:
    words = line.split()
    if words[0] == "hello":
        if how == "silent_start": time.sleep(60)
        print("hello rct/1 fake 1.0 roles=" + (sys.argv[2] if len(sys.argv) > 2 else "mote")
              + " time=virtual")
    elif words[0] == "reset":
        print("ready")
    elif words[0] == "bye":
        if how == "bad_end": sys.exit("could not save")
        break
    elif words[0] not in ("rx", "call", "linkack", "line", "power", "until"):
        print("done 0" if how == "yes_man" else "unsupported what is that")
    elif words[0] == "call" and words[2].startswith("join(") and how == "liar":
        print("up %s joined(10053:5 success)" % words[1])
        print("done " + words[1])
    elif words[0] == "call" and how == "unable":
        print("unsupported no calls")
    elif words[0] == "call" and how == "dies":
        print("out of memory \\x1b[31m at 0x1234", file=sys.stderr, flush=True)
        os.abort()
    elif words[0] == "call" and how == "hangs":
        time.sleep(60)
    elif words[0] == "until" and how == "stubborn":
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        with open(sys.argv[3] + ".new", "w") as file: file.write(str(os.getpid()))
        os.rename(sys.argv[3] + ".new", sys.argv[3])
        while True: time.sleep(60)
    elif words[0] == "call" and how == "babbles":
        print("hi there")
    else:
        print("done " + words[1])
    sys.stdout.flush()
'''


os.environ["GITHUB_ACTIONS"] = ""  # Where it is set, the suite annotates what fails.


def test(*args, **more):
    return rubric("test", *args, **more)


def is_dead(pid):
    """Gone, or dead and not yet waited for by whoever inherited it."""
    try:
        text = pathlib.Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return True
    return text.rpartition(")")[2].split()[0] == "Z"


def sleeps(seconds):
    """Returns whether a process sleeps for so long."""
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if path.read_bytes() == f"sleep\0{seconds}\0".encode():
                return True
        except OSError:
            pass
    return False


def comes(condition):
    """Returns whether it comes true in a time that is ample on any busy host."""
    end = time.monotonic() + 60
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return False


class Folder(AnyFolder):
    def setUp(self):
        super().setUp()
        self.fake_program = self.write("fake.py", FAKE)

    def fake(self, how, roles="mote"):
        return f"exec python3 {self.fake_program} {how} {roles}"

    def mote_with(self, old, new):
        """The Python mote with another text in it."""
        folder = self.folder / "mote"
        folder.mkdir(exist_ok=True)
        for name in ("adapter.py", "words.py", "mote.py"):
            text = (MOTE / name).read_text()
            if name == "mote.py":
                self.assertIn(old, text)
                text = text.replace(old, new)
            (folder / name).write_text(text)
        return f"exec python3 {folder}/adapter.py"

    def impatient_mote(self):
        return self.mote_with("JOIN_PERIOD = 500", "JOIN_PERIOD = 450")
