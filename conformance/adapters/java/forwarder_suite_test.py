#!/usr/bin/env python3
"""The suite at the base station's serial line: `rubric test --target sf-server:PORT`.

With the line alone most cases need to see the application or PEIS too, so they stay undecided;
with these behind `--app` nearly all are decided. None may fail. With a mistake that shows on the
line (one of bugs.json) some have to, by its rule.

Usage: forwarder_suite_test.py RUBRIC JAVAC JAVA
"""

import concurrent.futures
import json
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
MISTAKE = "reads_numbers_backwards"


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


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


def run_at_line(rubric, java, classes, report):
    """The cases of the report; the station connects as soon as somebody listens."""
    port = free_port()
    tested = subprocess.Popen([rubric, "test", "--target", f"sf-server:{port}", "--role",
                               "base_station", "--format", "json", "--out", str(report)])
    station = [java, "-cp", str(classes), "rubric.basestation.ForwarderClient",
               f"127.0.0.1:{port}", "11"]
    while tested.poll() is None:
        subprocess.run(station, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        time.sleep(0.1)
    return cases_of(report)


def run_with_application(rubric, java, classes, report):
    """The same; the station is the app's, which starts it anew for each case. In four parts."""
    parts = [report.with_suffix(f".{i}.json") for i in range(1, 5)]
    tested = []
    for i, part in enumerate(parts, 1):
        port = free_port()
        app = f"{java} -cp {classes} rubric.basestation.LiveAdapter 127.0.0.1:{port}"
        tested.append(subprocess.Popen([
            rubric, "test", "--target", f"sf-server:{port}:restart", "--app", app, "--role",
            "base_station", "--shard", f"{i}/4", "--format", "json", "--out", str(part)]))
    for one in tested:
        one.wait()
    return [case for part in parts for case in cases_of(part)]


def cases_of(report):
    implementation, = json.loads(report.read_text(encoding="utf-8"))["implementations"]
    return implementation["cases"]


def main():
    rubric, javac, java = sys.argv[1:]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        wrong = 0
        programs = {mistake: build(javac, folder, mistake) for mistake in ("", MISTAKE)}
        # Both stations at the line wait most of the time, so they run at once.
        with concurrent.futures.ThreadPoolExecutor() as both:
            at_line = {mistake: both.submit(run_at_line, rubric, java, classes,
                                            folder / f"line{mistake}.json")
                       for mistake, classes in programs.items()}
        with_application = run_with_application(rubric, java, programs[""],
                                                folder / "report.json")
        for mistake, run, cases, least in (
                ("", run_at_line, at_line[""].result(), 2),
                ("", run_with_application, with_application, 25),
                (MISTAKE, run_at_line, at_line[MISTAKE].result(), 0)):
            count = {v: sum(c["verdict"] == v for c in cases) for v in
                     {c["verdict"] for c in cases}}
            rules = {r for c in cases for f in c["failures"]
                     for r in f["requirements"] + f["suspected"]}
            tried = count.get("pass", 0) + count.get("inconclusive", 0) + count.get("fail", 0)
            found = "T2-CONTENT" in rules
            good = found if mistake else count.keys() <= {"pass", "inconclusive", "skip"}
            wrong += not good or tried < 30 or count.get("pass", 0) < least
            print(mistake or "as it is", run.__name__, count, " ".join(sorted(rules)), flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
