#!/usr/bin/env python3
"""Memory stays flat: real frames through a pipe, in every format.

Usage: memory_test.py RUBRIC [MEGABYTES]. 300 are two million frames: one allocation a frame that is
never freed shows.
"""

import pathlib
import re
import subprocess
import sys
import threading

CAPTURE = pathlib.Path("spec/captures/firmware/a_join_data.serial.bin")
MOST_KIB = 64 * 1024
MEGA = 1_000_000


def peak_kib(process):
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return int(re.search(r"VmHWM:\s+(\d+) kB", status)[1])


def feed(process, size):
    """Writes whole captures until `size` bytes are there; returns the peak seen meanwhile."""
    block = CAPTURE.read_bytes() * 100
    peak = 0
    for _ in range(size // len(block) + 1):
        process.stdin.write(block)
        peak = max(peak, peak_kib(process))
    return peak


def measure(rubric, size, *options):
    lines = 0

    def count():
        nonlocal lines
        while chunk := process.stdout.read(1 << 20):
            lines += chunk.count(b"\n")

    with subprocess.Popen([rubric, "decode", *options], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE) as process:
        counter = threading.Thread(target=count)
        counter.start()
        peak = feed(process, size)
        process.stdin.close()
        counter.join()
        code = process.wait()
    print(f"{' '.join(options)}: {lines} lines, peak {peak} KiB, exit {code}")
    return code == 0 and lines > size // 200 and peak <= MOST_KIB


def main():
    rubric = sys.argv[1]
    megabytes = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    good = measure(rubric, megabytes * MEGA, "--format", "jsonl")
    good &= measure(rubric, megabytes * MEGA // 6, "--format", "text")
    good &= measure(rubric, megabytes * MEGA // 6, "--format", "csv")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
