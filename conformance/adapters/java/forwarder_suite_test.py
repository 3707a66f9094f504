#!/usr/bin/env python3
"""The suite at the base station's serial line: `rubric test --target sf-server:PORT`.

With the line alone most cases need to see the application or PEIS too, so they stay undecided;
with these behind `--app` nearly all are decided. None may fail. With a mistake that shows on the
line (one of bugs.json) some of those that try its rule have to, by that rule.

Usage: forwarder_suite_test.py RUBRIC JAVAC JAVA [--line]: with --line all cases at the line alone.
"""

import concurrent.futures
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools/tests"))

# pylint: disable-next=wrong-import-position
from serial_testing import held_port

HERE = pathlib.Path(__file__).resolve().parent
MISTAKE = "reads_numbers_backwards"
ITS_RULE = "T2-CONTENT"
PARTS = 14
PARTS_OF_A_RULE = 9  # Of its few cases each gets some.
# They last two minutes each where time is real; java_base_station_suite_test runs them.
LONG = "many.*"
# A station lives for a second or two: code that runs once is not worth an optimising compiler.
SHORT_LIVED = ["-XX:TieredStopAtLevel=1", "-XX:+UseSerialGC", "-Xshare:auto"]


def build(javac, folder, mistake):
    tree = folder / (mistake or "good")
    shutil.copytree(HERE, tree)
    for bug in json.loads((HERE / "bugs.json").read_text(encoding="utf-8")):
        if bug["name"] == mistake:
            path = tree / bug["file"]
            text = path.read_text(encoding="utf-8")
            assert text.count(bug["old"]) == 1
            path.write_text(text.replace(bug["old"], bug["new"]), encoding="utf-8")
    subprocess.run([HERE / "build.sh", javac, tree, tree / "classes"], check=True)
    return tree / "classes"


def run_at_line(rubric, java, classes, report, which):
    """Those cases; the station connects as soon as somebody listens."""
    with held_port() as port:
        tested = subprocess.Popen([rubric, "test", "--target", f"sf-server:{port}", "--role",
                                   "base_station", "--except", LONG, "--format", "json", "--out",
                                   str(report), *which])
        station = [java, *SHORT_LIVED, "-cp", str(classes), "rubric.basestation.ForwarderClient",
                   f"127.0.0.1:{port}", "11"]
        while tested.poll() is None:
            subprocess.run(station, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
            time.sleep(0.1)
    return cases_of(report)


def run_with_application(rubric, java, classes, report, which):
    """The same; the station is the app's, which starts it anew for each case."""
    with held_port() as port:
        app = " ".join([java, *SHORT_LIVED, "-cp", str(classes), "rubric.basestation.LiveAdapter",
                        f"127.0.0.1:{port}"])
        subprocess.run([rubric, "test", "--target", f"sf-server:{port}:restart", "--app", app,
                        "--role", "base_station", "--except", LONG, "--format", "json", "--out",
                        str(report), *which])
    return cases_of(report)


def cases_of(report):
    implementation, = json.loads(report.read_text(encoding="utf-8"))["implementations"]
    return implementation["cases"]


def main():
    rubric, javac, java = sys.argv[1:4]
    at_line_alone = sys.argv[4:] == ["--line"]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        wrong = 0
        mistakes = ("",) if at_line_alone else ("", MISTAKE)
        programs = {mistake: build(javac, folder, mistake) for mistake in mistakes}
        # A station at a line waits most of the time, so many parts run at once.
        with concurrent.futures.ThreadPoolExecutor(max_workers=PARTS + 2 * PARTS_OF_A_RULE) as pool:
            def started(mistake, run, parts, *which):
                return [pool.submit(run, rubric, java, programs[mistake],
                                    folder / f"{mistake}{run.__name__}{i}.json",
                                    ["--shard", f"{i}/{parts}", *which])
                        for i in range(1, parts + 1)]
            if at_line_alone:
                runs = [("", run_at_line, 2, 30, started("", run_at_line, PARTS))]
            else:
                runs = [("", run_with_application, 25, 30,
                         started("", run_with_application, PARTS))]
                runs += [(mistake, run_at_line, 0, 1,
                          started(mistake, run_at_line, PARTS_OF_A_RULE, "--rule", ITS_RULE))
                         for mistake in mistakes]
        for mistake, run, passed, tried, results in runs:
            cases = [case for result in results for case in result.result()]
            bad = [case["name"] for case in cases if case["verdict"] in ("fail", "error")]
            if bad and not mistake:
                # A good station is late where others take its processor; twice it is not good.
                print("once more:", *bad, flush=True)
                again = run(rubric, java, programs[""], folder / "again.json",
                            [f"--cases={name}" for name in bad])
                cases = [case for case in cases if case["name"] not in bad] + again
            count = {v: sum(c["verdict"] == v for c in cases) for v in
                     {c["verdict"] for c in cases}}
            rules = {r for c in cases for f in c["failures"]
                     for r in f["requirements"] + f["suspected"]}
            found = ITS_RULE in rules
            good = found if mistake else count.keys() <= {"pass", "inconclusive", "skip"}
            wrong += (not good or count.get("pass", 0) < passed or
                      sum(count.values()) - count.get("skip", 0) < tried)
            print(mistake or "as it is", run.__name__, count, " ".join(sorted(rules)), flush=True)
            for case in [] if mistake else cases:
                if case["verdict"] not in ("pass", "inconclusive", "skip"):
                    print(json.dumps(case, indent=1), flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
