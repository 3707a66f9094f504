#!/usr/bin/env python3
"""Shows that the structure-aware mutator comes to a trap that plain libFuzzer does not come to.

Usage: planted_test.py [BUILD_FOLDER] [--seeds N] [--plain-seconds S], of a build of the fuzz
targets (build/fuzz); both programs are built if need be.

The trap (targets/planted_fuzz.cc) lies behind four valid messages in order, each of which repeats
what was said before. The same target is built with the mutator and without; both begin with one
serial frame and the dictionary. The mutator has to find the trap within 30 seconds of a processor's
time, so that a busy machine does not matter. Without it, ten times as many runs, or 30 seconds if
they are over before, must not. With --seeds the whole is done for that many seeds. Exit 1 if it
comes out otherwise.
"""

import argparse
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
AWARE = "planted_aware_fuzz"
PLAIN = "planted_plain_fuzz"
LIMIT_S = 30
WAIT_S = 4 * LIMIT_S  # By the clock.
MORE_RUNS = 10
SEED_FRAME = bytes.fromhex("7e4301be487e")  # The confirmation of a packet.
# For both alike. What counts is how far a sequence came, not how often a loop ran; and a mutant of
# a mutant has mostly lost the sequence.
OPTIONS = ["-max_len=400", "-use_counters=0", "-mutate_depth=1", "-print_final_stats=1",
           f"-dict={ROOT}/fuzz/dictionaries/rubicon.dict"]


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(program, seed, *options):
    """Returns whether the trap was found, and after how many runs and seconds of CPU time."""
    with tempfile.TemporaryDirectory() as work:
        corpus = pathlib.Path(work, "corpus")
        corpus.mkdir()
        (corpus / "ack.hdlc").write_bytes(SEED_FRAME)
        start = processor_s()
        done = subprocess.run(
            [program, f"-seed={seed}", f"-max_total_time={WAIT_S}", f"-artifact_prefix={work}/",
             *OPTIONS, *options, str(corpus)], capture_output=True, text=True, errors="replace",
            check=False)
        seconds = processor_s() - start
    runs = re.search(r"number_of_executed_units: (\d+)", done.stderr)
    found = "broken: nobody gets here" in done.stderr
    if not runs or (done.returncode != 0) != found:
        sys.exit(f"{program} did not run:\n{done.stderr[-2000:]}")
    return found, int(runs[1]), seconds


def one(build, seed, plain_seconds):
    found, runs, seconds = run(build / AWARE, seed)
    said = "found the trap" if found else "did not find the trap"
    print(f"seed {seed}: with the mutator {said}: {runs} runs, {seconds:.1f} s", flush=True)
    bound = [f"-max_total_time={plain_seconds}"]
    if plain_seconds == LIMIT_S:  # No more than it has to.
        bound.append(f"-runs={MORE_RUNS * runs}")
    plain_found, plain_runs, plain_s = run(build / PLAIN, seed, *bound)
    said = "found the trap" if plain_found else "did not find the trap"
    print(f"seed {seed}: plain libFuzzer {said}: {plain_runs} runs, {plain_s:.1f} s", flush=True)
    return found and seconds <= LIMIT_S and not plain_found, runs, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, nargs="?", default=ROOT / "build/fuzz",
                        help="the build folder of the fuzz targets (default: build/fuzz)")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--plain-seconds", type=int, default=LIMIT_S,
                        help="other than 30: plain libFuzzer runs for so long, however many runs")
    options = parser.parse_args()
    built = subprocess.run(["cmake", "--build", options.build, "--target", AWARE, PLAIN],
                           capture_output=True, text=True, check=False)
    if built.returncode != 0:
        sys.exit(built.stdout + built.stderr)
    rows = [one(options.build / "fuzz", seed, options.plain_seconds)
            for seed in range(1, options.seeds + 1)]
    good = sum(row[0] for row in rows)
    if options.seeds > 1:
        for name, column in (("runs", 1), ("seconds", 2)):
            values = sorted(row[column] for row in rows)
            print(f"{name} to the trap: least {values[0]:.1f}, median "
                  f"{values[len(values) // 2]:.1f}, most {values[-1]:.1f}")
    print(f"{good} of {len(rows)} as wanted")
    return 0 if good == len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
