#!/usr/bin/env python3
"""Output and work of commands grow no faster than their input, on shapes that provoke that.

Compares runs on 1, 10 and 100 parts of the same shape by bytes written and by CPU time. What grows
with the square takes 100 times for each step of 10, so the bounds are far from both.
Usage: linear_test.py RUBRIC
"""
import os
import struct
import subprocess
import sys
import tempfile
import unittest

from packets import interface, packet_block, radio, section
from testing import RUBRIC, Folder

PARTS = 60
STEP = 10
BYTES_MOST = 1.5 * STEP
CPU_MOST = 4 * STEP
CPU_MOST_IN_FULL = 1.4 * STEP  # Findings end at 4,096, seven times as many: the square is 20 times.
CPU_FLOOR_S = 0.1  # Less is start and noise.


def capture(frames, apart_us=1000):
    return section() + interface(230) + b"".join(packet_block(i * apart_us, frame)
                                                 for i, frame in enumerate(frames))


def request(number):
    return struct.pack(">HBHB", number & 0xFFFF, 1, 0x43, 1)


SHAPES = {
    "many senders that break a rule":
        lambda n: capture(radio(i, 0xFFFF, 1000 + i, 14, request(i)) for i in range(n)),
    "many senders of half a message":
        lambda n: capture(radio(i, 1, 1000 + i, 14, request(i)[:3]) for i in range(n)),
    "one sender that repeats itself":
        lambda n: capture(radio(i, 0xFFFF, 2, 14, request(i)) for i in range(n)),
    "everybody to everybody":
        lambda n: capture(radio(i, 1000 + i * 7 % n, 1000 + i, 14, request(7)) for i in range(n)),
    "all at once":
        lambda n: capture((radio(i, 1, 1000 + i, 14, request(i)) for i in range(n)), 0),
    "types that nobody knows":
        lambda n: capture(radio(i, 1, 2, i & 255, b"\xff" * 90) for i in range(n)),
}
ALL_IN_FULL = ("check", "--verbose", "--max-findings", "1000000")
COMMANDS = (("check",), ("check", "--verbose"), ALL_IN_FULL, ("check", "--format", "json"),
            ("check", "--format", "junit"), ("decode",), ("decode", "--format", "jsonl"),
            ("decode", "--format", "csv", "--fields", "time,message"), ("decode", "--hex"),
            ("check", "--report", "@"), ("stats",), ("convert", "--format", "hex"))


HEAD = "%rtr 1\n%node m5 mote id=5\n%node sA sink id=1 island=11 iut\n"
REQUEST = "sA < rA am=5->1 join_request(seq_num={} mote_type=telosb_demo ...)"
# Logs and cases as text. What is last is what a file of so many lines may look like at worst.
TEXTS = {
    "comments": lambda n: HEAD + "; c\n" * 10 * n,
    "comments of nothing": lambda n: HEAD + ";\n" * 10 * n,
    "blank lines": lambda n: HEAD + "\n" * 20 * n,
    "blank lines between comments": lambda n: HEAD + ";\n\n" * 5 * n,
    "cases of nothing": lambda n: HEAD + "".join(f"case c{i}\n" for i in range(10 * n)),
    "lines that are wrong": lambda n: HEAD + "case c\n" + "x\n" * 5 * n,
    "a log of requests":
        lambda n: HEAD + "case c\n" + "".join(
            f"{i * 1000} {REQUEST.format(i & 0xFFFF)}\n" for i in range(n)),
    "a log of little": lambda n: HEAD + "case c\n" + "".join(
        f"{i} sA < rA ack_join(*)\n" for i in range(n)),
    "rules by the line":
        lambda n: HEAD + "case c\n" + "".join(
            f"{i * 1000} {REQUEST.format(1)} [{'J3-REPLY ' * 8}J4-SEQ]\n" for i in range(n)),
}
TEXT_COMMANDS = (("check",), ("test", "--list"), ("test", "--target", "machine"), ("chart",))
# What a log or a case may consist of: each kind of line, of which a file has any number.
LINES = {
    "busy lines": "0 sA < rA busy\n",
    "lines that are busy and idle": "0 sA < rA busy\n0 sA < rA idle\n",
    "busy lines of two links": "0 sA < serA busy\n0 sA < rA idle\n",
    "new starts": "0 sA < power reboot\n",
    "busy lines and new starts": "0 sA < app busy\n0 sA < power reboot\n",
    "no power": "0 sA < power off\n",
    "calls": "0 m5 < app get_clock()\n",
    "link acks": "0 m5 < rA linkack(acked=1)\n",
    "no link acks": "0 m5 < rA linkack(acked=0)\n",
    "frames": "0 sA < rA am=5->1 am(type=1 payload=x)\n",
    "packets": "0 sA < serA * | 00\n",
    "frames in hex": "0 sA > rA * | 0000010002010006 03\n",
    "what must not be": "0 sA !> * *\n",
    "what may be": "0 sA ?> * *\n",
    "what is at a time": "@0 sA > * *\n",
    "what comes within terms": "0..members * > * *\n",
    "faults": "0 rA lost *\n",
    "comments of lines": "0 sA > * * ; c\n",
    "lists": "0 sA > rA net_msg(payload.body.values=[1 2 3] ...)\n",
    "notes": "%note x\n",
}
COUNTED = {
    "labels": lambda i: f"a{i}: 0 sA > * *\n",
    "times after labels": lambda i: f"a{i}: {f'a{i - 1}+' if i else ''}0 sA > * *\n",
    "variables": lambda i: f"0 sA > rA join_reply(seq_num=$q{i} ...)\n",
    "nodes": lambda i: f"%node n{i} mote id=5\n",
    "links": lambda i: f"%link r{i} radio sA\n",
    "cases with a line": lambda i: f"case a{i}\n0 sA > * *\n",
}
LINES_LEAST = 2000  # Of them; then tenfold.
LINES_CPU_MOST = 3 * STEP
LINES_CPU_FLOOR_S = 0.02
MEMORY_MOST = 20  # Times the file's size.
MEMORY_FLOOR = 2 << 20
# What only reads. A run keeps each line besides, and the failure that it may be.
MEMORY_A_LINE = {("check",): 0, ("test", "--list"): 0, ("test", "--target", "machine"): 1200}


# A process's most memory begins with that of the one that started it: here, a small one, which
# takes a list of words a line and the file for what they write.
STARTER = """
import os, sys
for line in sys.stdin:
    out, *words = eval(line)
    actions = [(os.POSIX_SPAWN_OPEN, 1, out, os.O_WRONLY, 0),
               (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0)]
    child = os.posix_spawn(words[0], words, os.environ, file_actions=actions)
    _, status, usage = os.wait4(child, 0)
    print(os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss,
          flush=True)
"""


class Linear(Folder):
    @classmethod
    def setUpClass(cls):
        cls.starter = subprocess.Popen([sys.executable, "-ISc", STARTER], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, text=True)

    @classmethod
    def tearDownClass(cls):
        cls.starter.communicate()

    def measure(self, command, path, codes):
        """Returns bytes written, CPU seconds and the most memory."""
        with tempfile.NamedTemporaryFile() as out:
            words = [path.parent / "report" if word == "@" else word for word in command]
            print([str(word) for word in (out.name, RUBRIC, *words, path)],
                  file=self.starter.stdin, flush=True)
            code, cpu, most_kib = self.starter.stdout.readline().split()
            self.assertIn(int(code), codes, command)
            return out.seek(0, os.SEEK_END), float(cpu), int(most_kib) * 1024

    def grows(self, name, command, inputs, path, codes=(0, 1, 3), cpu_most=CPU_MOST,
              cpu_floor_s=CPU_FLOOR_S):
        """Returns the memory for each of the inputs."""
        before = None
        memory = []
        for data in inputs:
            path.write_bytes(data)
            size, cpu, most = self.measure(command, path, codes)
            if before:
                self.assertLessEqual(size, BYTES_MOST * before[0] + 2000, (name, command))
                self.assertLessEqual(cpu, cpu_most * max(before[1], cpu_floor_s), (name, command))
            before = size, cpu
            memory.append(most)
        return memory

    def is_bounded(self, name, command, inputs, memory):
        if command not in MEMORY_A_LINE:
            return
        lines = inputs[-1].count(b"\n")
        self.assertLessEqual(memory[-1] - memory[0], MEMORY_MOST * len(inputs[-1]) +
                             MEMORY_A_LINE[command] * lines + MEMORY_FLOOR, (name, command))

    def test_captures(self):
        path = self.folder / "x.pcapng"
        for name, shape in SHAPES.items():
            inputs = [shape(PARTS * STEP ** power) for power in range(3)]
            for command in COMMANDS:
                most = CPU_MOST_IN_FULL if command is ALL_IN_FULL else CPU_MOST
                self.grows(name, command, inputs, path, cpu_most=most)

    def test_texts(self):
        path = self.folder / "x.rtr"
        for name, shape in TEXTS.items():
            inputs = [shape(PARTS * STEP ** power).encode() for power in range(3)]
            for command in TEXT_COMMANDS:
                memory = self.grows(name, command, inputs, path, (0, 1, 2, 3, 64, 66))
                self.is_bounded(name, command, inputs, memory)

    def is_linear(self, name, shape, commands=TEXT_COMMANDS):
        path = self.folder / "x.rtr"
        inputs = [shape(LINES_LEAST * STEP ** power).encode() for power in range(2)]
        for command in commands:
            memory = self.grows(name, command, inputs, path, (0, 1, 2, 3, 64, 66), LINES_CPU_MOST,
                                LINES_CPU_FLOOR_S)
            if name not in ("nodes", "links"):  # Headers are kept.
                self.is_bounded(name, command, inputs, memory)

    def test_each_kind_of_line(self):
        for name, line in LINES.items():
            self.is_linear(name, lambda n: HEAD + "case c\n" + line * (n // line.count("\n")))

    def test_each_kind_of_line_that_differs(self):
        for name, line in COUNTED.items():
            self.is_linear(name, lambda n: HEAD + "case c\n" + "".join(map(line, range(n))))

    def test_variables_that_outputs_bind(self):
        self.is_linear("variables", lambda n: HEAD + "case c\n" + "".join(
            f"3 {REQUEST.format(i & 0xFFFF)}\n0..2 sA > rA join_reply(seq_num=$q{i} ...)\n"
            for i in range(n)), (("test", "--target", "machine"),))

    def test_lines_times_outputs(self):
        """Lines that look for outputs of one message in a window that holds all of them."""
        path = self.folder / "x.rtr"
        least = 300
        for name, line in (("not kept", "> rA join_reply(seq_num={1} ...)"),
                           ("kept", "> rA join_reply(seq_num={0} ...)"),
                           ("any", "> rA join_reply(*)"),
                           ("forbidden", "!> rA join_reply(seq_num={0} ...)"),
                           ("not forbidden", "!> rA join_reply(seq_num={1} ...)"),
                           ("allowed", "?> rA join_reply(seq_num={1} ...)"),
                           ("by address", "?> rA am=1->{1} *"),
                           ("by packet", "?> rA * | 00ffff000002000f{1:04x}"),
                           ("frames", "!> rA am(type=15 payload=x{1:04x})"),
                           ("not kept, alike", "> rA join_reply(seq_num=40000..50000 ...)"),
                           ("not forbidden, alike", "!> rA join_reply(island_addr=!11 ...)"),
                           ("others", "> rA ack_join(*)")):
            inputs = [(HEAD + "case c\n" + "".join(
                f"3 {REQUEST.format(i)}\n" for i in range(n)) + "".join(
                    f"@0..{4 * n} sA {line.format(i, i + 30000)}\n" for i in range(n))).encode()
                      for n in (least, least * STEP)]
            self.grows(name, ("test", "--target", "machine"), inputs, path, (0, 1),
                       LINES_CPU_MOST, LINES_CPU_FLOOR_S)

    def test_many_nodes_and_links_with_lines(self):
        """In a log; a case has few, and the runner and a chart look for each among all."""
        self.is_linear("nodes", lambda n: HEAD + "".join(
            f"%node n{i} mote id=5\n" for i in range(n // 2)) + "case c\n" + "".join(
                f"0 n{i} > rA *\n" for i in range(n // 2)), (("check",),))
        self.is_linear("links", lambda n: HEAD + "".join(
            f"%link r{i} radio\n" for i in range(n // 2)) + "case c\n" + "".join(
                f"0 sA > r{i} *\n" for i in range(n // 2)), (("check",),))

    def test_a_cut_line(self):
        self.is_linear("a cut line", lambda n: HEAD + "case c\n" + "0 sA > r *\n" * n + "0 sA >")

    def test_bytes_as_text(self):
        """Hex, which every command takes that takes captures."""
        path = self.folder / "x.hex"
        for name, line in (("packets", b"0 00ffff00050700430001000701\n"), ("nothing", b"\n"),
                           ("half a byte", b"0 0\n"), ("no hex", b"x\n")):
            inputs = [line * (LINES_LEAST * STEP ** power) for power in range(2)]
            for command in (("check",), ("convert", "--input-format", "hex", "--format", "hdlc",
                                         "-o", "-")):
                self.grows(name, command, inputs, path, (0, 1, 3, 66), LINES_CPU_MOST,
                           LINES_CPU_FLOOR_S)

    def test_lines(self):
        """What encodes, and what is encoded."""
        path = self.folder / "x.jsonl"
        good = b'{"message":"join_reply","fields":{"island_addr":11,"mote_addr":5}}\n'
        for name, line in (("messages", good), ("nothing", b"\n"), ("no JSON", b"{{{{\n"),
                           ("deep", b"[" * 40 + b"]" * 40 + b"\n")):
            inputs = [line * (PARTS * STEP ** power) for power in range(3)]
            self.grows(name, ("encode", "--format", "hex"), inputs, path, (0, 1, 3, 66))
            self.grows(name, ("decode", "--input-format", "hex"), inputs, path, (0, 1, 3))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
