"""The fuzz targets of a build and how libFuzzer runs them: shared by the scripts of this folder."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build/fuzz"
WORK = ROOT / "build/fuzzing"  # what fuzzing writes: never a corpus of the checkout
RSS_LIMIT_MB = 2048
ARTIFACTS = ("crash-", "leak-", "oom-", "timeout-")


class Target:
    """A line of fuzz_targets.tsv, which rubric_fuzzer() writes, in the build folder `build`."""

    def __init__(self, build, line):
        (self.name, dictionary, max_len, smoke_runs, folders, timeout,
         repro) = line.rstrip("\n").split("\t")
        self.build = build
        self.dictionary = None
        if dictionary != "-":
            self.dictionary = ROOT / "fuzz/dictionaries" / f"{dictionary}.dict"
        self.max_len = int(max_len)
        self.smoke_runs = int(smoke_runs)
        self.folders = [ROOT / folder for folder in folders.split()]
        # The corpus may be newer than the build folder, or gone since.
        self.folders = [f for f in self.folders if f != self.corpus]
        if self.corpus.is_dir():
            self.folders.insert(0, self.corpus)
        self.timeout_s = int(timeout)
        self.repro = repro == "repro"  # `rubric repro` writes its inputs as traces

    @property
    def program(self):
        return self.build / "fuzz" / f"{self.name}_fuzz"

    @property
    def source(self):
        return ROOT / "fuzz/targets" / f"{self.name}_fuzz.cc"

    @property
    def corpus(self):
        """The corpus in the checkout, which people name and `fuzz/minimize` adds to."""
        return ROOT / "fuzz/corpora" / self.name

    @property
    def work(self):
        return WORK / self.name

    def seeds(self):
        """Every file of the corpus and of the other seeds."""
        files = [f for folder in self.folders for f in sorted(folder.rglob("*"))]
        return [f for f in files if f.is_file()]

    def property(self):
        return property_of(self.source)

    def options(self):
        """libFuzzer's options that hold for every run of this target."""
        options = [f"-max_len={self.max_len}", f"-timeout={self.timeout_s}",
                   f"-rss_limit_mb={RSS_LIMIT_MB}"]
        if self.dictionary:
            options.append(f"-dict={self.dictionary}")
        return options


def sources():
    """The files of the targets; one without a property is only a test of the mutators."""
    files = sorted((ROOT / "fuzz/targets").glob("*_fuzz.cc"))
    return [f for f in files if not property_of(f).startswith("none")]


def property_of(source):
    """The sentence that a target's first lines state."""
    words = []
    for line in source.read_text(encoding="utf-8").splitlines():
        if not line.startswith("// "):
            break
        words.append(line[3:].strip())
    text = " ".join(words)
    if not text.startswith("Property: "):
        raise SystemExit(f"{shown(source)}: its first line is not `// Property: ...`")
    return text[len("Property: "):].rstrip(".")


def shown(path):
    """A path as people write it: from the project's folder where it lies in there."""
    path = pathlib.Path(path)
    return path.relative_to(ROOT) if path.is_relative_to(ROOT) else path


def load(build):
    table = pathlib.Path(build) / "fuzz_targets.tsv"
    if not table.exists():
        raise SystemExit(f"{shown(table)}: not there; configure the preset `fuzz` first")
    with open(table, encoding="utf-8") as file:
        return sorted((Target(pathlib.Path(build), line) for line in file), key=lambda t: t.name)


def choose(targets, names):
    known = {t.name: t for t in targets}
    for name in names:
        if name not in known:
            raise SystemExit(f"{name}: no such target; there are: {' '.join(known)}")
    return [known[name] for name in names] if names else targets


def run_build_step(command):
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode != 0:
        sys.stderr.write(done.stdout)
        raise SystemExit(f"{' '.join(map(str, command))}: failed")


def configure(preset):
    """The targets of a preset's build folder, configured anew if a CMakeLists.txt has changed."""
    build = ROOT / "build" / preset
    if (build / "build.ninja").exists() and (build / "fuzz_targets.tsv").exists():
        run_build_step(["cmake", "--build", build, "--target", "build.ninja"])
    else:
        run_build_step(["cmake", "--preset", preset])
    return load(build)


def compile_targets(targets, suffix=""):
    if not targets:
        return
    print(f"building {len(targets)} targets in {shown(targets[0].build)}", flush=True)
    names = [f"{t.name}_fuzz{suffix}" for t in targets]
    run_build_step(["cmake", "--build", targets[0].build, "--target", *names])


def environment():
    """The environment of a sanitized program: stacks with names, if a symbolizer is there."""
    found = dict(os.environ)
    symbolizer = shutil.which("llvm-symbolizer") or shutil.which("llvm-symbolizer-14")
    if symbolizer:
        found.setdefault("ASAN_SYMBOLIZER_PATH", symbolizer)
        found.setdefault("UBSAN_SYMBOLIZER_PATH", symbolizer)
    found.setdefault("UBSAN_OPTIONS", "print_stacktrace=1")
    return found


class Run:
    """One run of libFuzzer: its process, its log and, at the end, what came of it."""

    def __init__(self, target, corpus, finds, limit, extra=()):
        """`corpus` is written to, `finds` takes inputs that break the target, `limit` is
        libFuzzer's option that ends the run."""
        self.target = target
        self.finds = finds
        self.interrupted = False
        for folder in (corpus, finds):
            folder.mkdir(parents=True, exist_ok=True)
        self.log = finds.parent / "log"
        self.before = self.artifacts()
        self.started = time.monotonic()
        command = [target.program, *target.options(), limit, "-print_final_stats=1",
                   f"-artifact_prefix={finds}/", *extra, corpus, *target.folders]
        with open(self.log, "wb") as log:
            # A session of its own: Ctrl-C reaches the script alone, which then ends the run.
            self.process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT,
                                            env=environment(), cwd=ROOT, start_new_session=True)

    def interrupt(self):
        """As Ctrl-C does: the engine says what it did and ends."""
        self.interrupted = True
        self.process.send_signal(signal.SIGINT)

    def artifacts(self):
        return {f for f in self.finds.iterdir() if f.name.startswith(ARTIFACTS)}

    def text(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def result(self):
        return Result(self)


class Result:
    """Reads a run's log: runs, runs_per_s, coverage, corpus_size, crashes, cause."""

    def __init__(self, run):
        text = run.text()
        self.target = run.target
        self.log = run.log
        self.seconds = time.monotonic() - run.started
        self.code = run.process.returncode
        self.crashes = sorted(run.artifacts() - run.before)
        self.runs = self.last(r"stat::number_of_executed_units:\s*(\d+)", text) \
            or self.last(r"^#(\d+)\t", text)
        self.runs_per_s = self.last(r"stat::average_exec_per_sec:\s*(\d+)", text) \
            or int(self.runs / max(self.seconds, 1))
        self.coverage = self.last(r"\bcov: (\d+)", text)
        self.corpus_size = self.last(r"\bcorp: (\d+)/", text)
        ended = run.interrupted or self.code in (0, None)
        self.failed = bool(self.crashes) or not ended
        self.cause = self.cause_in(text) if self.failed else ""

    @staticmethod
    def last(pattern, text):
        found = re.findall(pattern, text, re.M)
        return int(found[-1]) if found else 0

    @staticmethod
    def cause_in(text):
        for pattern in (r"^broken: .*$", r"runtime error: .*$", r"^  what\(\):.*$",
                        r"^SUMMARY: .*$",
                        r"ERROR: libFuzzer: .*$", r"^==\d+== ?ERROR: .*$"):
            found = re.search(pattern, text, re.M)
            if found:
                return found[0]
        return text.strip().splitlines()[-1] if text.strip() else "it said nothing"


class Pool:
    """Runs targets, at most `jobs` at a time; `start(target)` gives a Run."""

    def __init__(self, jobs, start, report, progress=None):
        self.jobs, self.start = jobs, start
        self.report, self.progress = report, progress

    def run(self, targets):
        """Results in the order of their ends. Ctrl-C ends what runs, and is raised again after its
        results are there, in `self.results`."""
        waiting, running, self.results = list(targets), [], []
        told = time.monotonic()
        interrupted = None
        while waiting or running:
            try:
                while waiting and len(running) < self.jobs:
                    running.append(self.start(waiting[0]))
                    waiting.pop(0)
                time.sleep(0.1)
                if self.progress and time.monotonic() - told >= 10:
                    told = time.monotonic()
                    for run in running:
                        self.progress(run)
            except KeyboardInterrupt as stop:
                if interrupted:
                    for run in running:
                        run.process.kill()
                interrupted, waiting = stop, []
                for run in running:
                    run.interrupt()
            for run in [r for r in running if r.process.poll() is not None]:
                running.remove(run)
                self.results.append(run.result())
                self.report(self.results[-1])
        if interrupted:
            raise interrupted
        return self.results
