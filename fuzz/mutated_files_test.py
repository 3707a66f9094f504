#!/usr/bin/env python3
"""The whole program against mutated files of each kind that it reads: it ends with an exit code of
its own, and no sanitizer speaks.

Usage: mutated_files_test.py RUBRIC KIND [FILES]. Captures and logs are read by --each, a
process each without its start, a hundred in turn by decode and by check; other kinds, and a tenth
of the captures by other commands, by a process each from its start on.
"""

import concurrent.futures
import gzip
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
RUBRIC = os.path.abspath(sys.argv[1])
KIND = sys.argv[2]
COUNT = int(sys.argv[3]) if len(sys.argv) > 3 else 10_000
CODES = {0, 1, 3, 64, 66}
SANITIZER = 99
PATIENCE_S = 60
GROUP = 100  # Files of one --each.
SEED_BYTES_MOST = 40_000  # Of a tenth of the files.
FEW_BYTES_MOST = 3_000  # Of the others: what a file takes is by its size.
NUMBERS = [b"\0", b"\xff", b"\x7f", b"\x80", b"\0\0", b"\xff\xff", b"\xff\xff\xff\xff",
           b"\0\0\0\x80", b"\x7e", b"\x7d"]
CAPTURE = ROOT / "spec/captures/firmware/d1_lose_request.pcapng"
ENVIRONMENT = {**os.environ,
               "ASAN_OPTIONS": f"exitcode={SANITIZER}:detect_leaks=0:"
                               "allocator_may_return_null=1:malloc_context_size=1",
               "UBSAN_OPTIONS": f"exitcode={SANITIZER}:print_stacktrace=1"}


def converted(name, *words):
    """Each small capture as `rubric convert` writes it."""
    for capture in sorted((ROOT / "spec/captures/firmware").glob("*.pcapng")):
        out = subprocess.run([RUBRIC, "convert", capture, "--format", name, "-o", "-", *words],
                             capture_output=True, check=False, env=ENVIRONMENT).stdout
        if out:
            yield out


def files(*patterns):
    for pattern in patterns:
        for path in sorted(ROOT.glob(pattern)):
            yield path.read_bytes()


def decoded():
    for capture in sorted((ROOT / "spec/captures/firmware").glob("*.pcapng")):
        yield subprocess.run([RUBRIC, "decode", capture, "--format", "jsonl", "--count", "20"],
                             capture_output=True, check=False, env=ENVIRONMENT).stdout


# By kind, which is a file's ending: what mutants are made of.
SEEDS = {
    "bin": lambda: files("spec/captures/firmware/*.serial.bin"),
    "hex": lambda: converted("hex"),
    "jsonl": decoded,
    "ksy": lambda: files("spec/wire/*.ksy", "spec/wire/run_time/*.ksy"),
    "pcap": lambda: converted("pcap", "--only", "radio"),
    "pcapng": lambda: files("spec/captures/firmware/*.pcapng"),
    "gz": lambda: (gzip.compress(one, mtime=0) for one in SEEDS["pcapng"]()),
    "rtr": lambda: files("conformance/cases/*.rtr", "conformance/check/tests/testdata/*.rtr"),
    "sf": lambda: files("spec/captures/basestation/*.sfstream"),
    "yaml": lambda: files("tools/expect/*.check.yaml"),
}


def mutated(texts, rng, most):
    text = bytearray(rng.choice(texts))
    if len(text) > most:
        begin = rng.choice([0, rng.randrange(len(text) - most)])
        text = text[begin:begin + most]
    for _ in range(1 << rng.randrange(6)):
        at = rng.randrange(len(text) + 1)
        some = rng.randrange(1, 1 << rng.randrange(1, 8))
        how = rng.randrange(7)
        if how == 0 and text:
            text[at % len(text)] ^= 1 << rng.randrange(8)
        elif how == 1 and text:
            text[at % len(text)] = rng.randrange(256)
        elif how == 2:
            text[at:at] = rng.randbytes(some)
        elif how == 3:
            del text[at:at + some]
        elif how == 4:
            text[at:at] = text[at:at + some] * rng.randrange(1, 4)
        elif how == 5:
            number = rng.choice(NUMBERS)
            text[at:at + len(number)] = number
        else:
            other = rng.choice(texts)
            begin = rng.randrange(len(other))
            text[at:at + some] = other[begin:begin + some]
    if rng.randrange(4) == 0:
        del text[rng.randrange(len(text) + 1):]
    return bytes(text)


def alone(words):
    """What is wrong with a run of the program; empty: nothing."""
    try:
        done = subprocess.run([RUBRIC, *map(str, words)], stdin=subprocess.DEVNULL, check=False,
                              capture_output=True, timeout=PATIENCE_S, env=ENVIRONMENT)
    except subprocess.TimeoutExpired:
        return f"hangs: {words}"
    if done.returncode in CODES:
        return ""
    return f"ends with {done.returncode}: {words}\n{done.stderr.decode(errors='replace')[-3000:]}"


def each(folder, group):
    """What is wrong with a run of --each; empty: nothing."""
    command = ("decode", "check")[group % 2]
    files = f"{folder}/{group:03}*"
    # All of a run are ended with it.
    words = ["timeout", "--signal=KILL", str(PATIENCE_S + GROUP), RUBRIC, command, "--each", files,
             "--jobs", "1"]
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=False,
                          env=ENVIRONMENT)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    found = [str(line)[:3000] for line in lines if line["exit_code"] not in CODES]
    if len(lines) != GROUP:
        found.append(f"ends with {done.returncode} or hangs after {len(lines)} files\n"
                     + done.stderr.decode(errors="replace")[-3000:])
    return "\n".join(f"{command} --each {files}: {one}" for one in found)


# What else reads a kind of file; {} is the file.
COMMANDS = {
    "pcapng": [["stats", "{}"], ["convert", "{}", "-o", "/dev/null", "--format", "hex"],
               ["decode", "{}", "--hex", "--units"], ["decode", "{}", "--format", "csv"],
               ["check", "{}", CAPTURE, "--verbose"]],
    "bin": [["stats", "{}", "--format", "json"], ["decode", "{}", "--format", "jsonl"],
            ["convert", "{}", "-o", "/dev/null", "--format", "pcapng"]],
    "hex": [["decode", "{}", "--as", "net_msg"]],
    "rtr": [["test", "--target", "machine", "{}"], ["chart", "{}"], ["test", "--list", "{}"]],
    "jsonl": [["encode", "{}", "-o", "/dev/null"], ["encode", "{}", "--as", "updates"]],
    "ksy": [["decode", CAPTURE, "--spec", "{}"]],
    "yaml": [["check", CAPTURE, "--expect", "{}"]],
}
ALONE = ("jsonl", "ksy", "yaml")  # --each does not take these.


def tried(folder):
    """All that is wrong with mutants of the kind."""
    texts = [text for text in SEEDS[KIND]() if text]
    rng = random.Random(KIND)
    paths = [folder / f"{i:05}.{KIND}" for i in range(COUNT)]
    for i, path in enumerate(paths):
        path.write_bytes(mutated(texts, rng, SEED_BYTES_MOST if i % 10 == 5 else FEW_BYTES_MOST))
    groups = range(0 if KIND in ALONE else COUNT // GROUP)
    if KIND not in ALONE:
        paths = paths[::10]
    commands = COMMANDS.get(KIND, [["stats", "{}"]])
    runs = [[path if word == "{}" else word for word in commands[i % len(commands)]]
            for i, path in enumerate(paths)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from filter(None, pool.map(lambda group: each(folder, group), groups))
        yield from filter(None, pool.map(alone, runs))


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="rubric-mutated-"))
    found = list(tried(folder))
    for one in found[:5]:
        print(one)
    print(f"{COUNT} files, {len(found)} are not taken as they should")
    if found:
        print(f"kept in {folder}")
        return 1
    shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
