#!/usr/bin/env python3
"""A fleet's captures on a Slurm cluster of one node, which dies meanwhile, and in SQL.

Usage: fleet_test.py RUBRIC. Debian's munged, slurmctld and slurmd on this host, in a folder and at
ports of their own; needs `npm ci` in this folder, which tools/test --all does.
"""

import collections
import datetime
import getpass
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

RUBRIC = os.path.abspath(sys.argv.pop(1))
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
CAPTURES = sorted((ROOT / "spec/captures/firmware").glob("*.pcapng"))
COUNT = 10_000
SHARDS = 4
DAYS = 14
FIRST_DAY = datetime.date(2026, 3, 1)
PATIENCE_S = 600
FULL_SHARD = 4  # Its disk is full at first; it begins after the node is up again.
DEAD_SHARD = 1  # Its node dies.
CONFIGURATION = """\
ClusterName=fleet
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=5
BatchStartTimeout=5
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE
"""
# The disk of the first try of a shard takes 100 blocks of 1 kB a file.
RUBRIC_ON_A_FULL_DISK = """\
#!/usr/bin/env bash
if [ "$SLURM_ARRAY_TASK_ID/${{SLURM_RESTART_COUNT:-0}}" = {shard}/0 ]; then
  trap '' XFSZ
  ulimit -f 100
fi
exec {rubric} "$@"
"""


def free_ports(count):
    held = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


def at_day(capture, day):
    """The bytes of a pcapng file with microseconds, its stamps moved to a day."""
    out = bytearray(capture)
    shift = int(datetime.datetime.combine(day, datetime.time(12), datetime.timezone.utc)
                .timestamp()) * 1_000_000
    place = 0
    while place < len(out):
        kind, size = struct.unpack_from("<II", out, place)
        if kind == 6:  # A packet: interface, then the two halves of its stamp.
            high, low = struct.unpack_from("<II", out, place + 12)
            stamp = (high << 32 | low) + shift
            struct.pack_into("<II", out, place + 12, stamp >> 32, stamp & 0xFFFFFFFF)
        place += size
    return bytes(out)


class Cluster:
    """A controller and one node, for one user."""

    def __init__(self, folder):
        self.folder = folder
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.configuration = folder / "slurm.conf"
        self.configuration.write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user=getpass.getuser(), folder=folder,
            ports=free_ports(2)))
        self.environment = {**os.environ, "SLURM_CONF": str(self.configuration),
                            "PATH": os.environ["PATH"] + ":/usr/sbin"}
        self.running = {}
        self.start("munged", "-F", "--force", f"--socket={folder}/munge.socket",
                   f"--key-file={key}", f"--pid-file={folder}/munge.pid",
                   f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.until(lambda: (folder / "munge.socket").exists())
        self.start("slurmctld", "-D", "-i")
        self.start_node()

    def start(self, program, *arguments):
        with open(self.folder / f"{program}.log", "ab") as log:
            self.running[program] = subprocess.Popen(
                ["setpriv", "--pdeathsig", "KILL", program, *arguments],  # None outlives the test.
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=self.environment)

    def start_node(self):
        self.start("slurmd", "-D")
        self.until(lambda: self.node_state() in ("idle", "mix", "alloc"))

    def node_state(self):
        return self.ask("sinfo", "-h", "-o", "%t", check=False).strip()

    def ask(self, *words, check=True):
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True,
                              check=False, timeout=PATIENCE_S)
        if check and done.returncode != 0:
            raise AssertionError(f"{words}: {done.stderr}{self.logs()}")
        return done.stdout

    def jobs_processes(self):
        """The processes of the node's jobs, and those of Slurm that lead them."""
        ours = f"SLURM_CONF={self.configuration}\0".encode()
        daemons = {process.pid for process in self.running.values()}
        for process in pathlib.Path("/proc").iterdir():
            if not process.name.isdigit() or int(process.name) in daemons:
                continue
            try:
                if ours in (process / "environ").read_bytes():
                    yield int(process.name)
            except OSError:
                pass  # Ended meanwhile, or somebody else's.

    def kill_node(self):
        """Ends the node's daemon and all that it runs, as when its power fails; the controller
        notices."""
        self.end(self.running.pop("slurmd"))
        self.until(lambda: "down" in self.node_state() or not self.ask("squeue", "-h", "-t", "R"))

    def end(self, daemon):
        if daemon is None:
            return
        daemon.kill()
        daemon.wait()
        while processes := list(self.jobs_processes()):
            for process in processes:
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            time.sleep(0.05)

    def stop(self):
        self.end(self.running.pop("slurmd", None))
        for process in self.running.values():
            process.kill()
            process.wait()

    def logs(self):
        return "".join(f"\n== {path.name}\n{path.read_text(errors='replace')[-2000:]}"
                       for path in sorted(self.folder.glob("*.log")))

    def until(self, holds):
        deadline = time.monotonic() + PATIENCE_S
        while not holds():
            if time.monotonic() > deadline:
                raise AssertionError("did not come" + self.logs())
            time.sleep(0.1)

    def begin_what_waits(self):
        """Slurm waits two minutes before it does a job again."""
        for job in self.ask("squeue", "-h", "-t", "PD", "-o", "%A %r").splitlines():
            number, why = job.split(maxsplit=1)
            if why == "BeginTime":
                self.ask("scontrol", "update", f"JobId={number}", "StartTime=now", check=False)

    def restarts(self):
        """How often each task of the array was begun again."""
        shown = self.ask("scontrol", "show", "job", "--oneliner")
        return {int(task): int(count) for task, count in
                re.findall(r"ArrayTaskId=(\d+) .*?Restarts=(\d+)", shown)}


class Fleet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubric-fleet-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.captures = cls.folder / "captures"
        cls.expected = collections.Counter()
        failures = [cls.failures_of(capture) for capture in CAPTURES]
        for i in range(COUNT):
            which = i % len(CAPTURES)
            day = FIRST_DAY + datetime.timedelta(i // len(CAPTURES) % DAYS)
            folder = cls.captures / f"site{i % 7}" / str(day)
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{i}.pcapng").write_bytes(at_day(CAPTURES[which].read_bytes(), day))
            for rule, count in failures[which].items():
                cls.expected[str(day), rule] += count
                cls.expected[str(day), rule, "captures"] += 1

    @staticmethod
    def failures_of(capture):
        done = subprocess.run([RUBRIC, "check", capture, "--format", "json"], check=False,
                              capture_output=True, timeout=PATIENCE_S)
        return collections.Counter(finding["requirement"]
                                   for finding in json.loads(done.stdout)["findings"]
                                   if finding["severity"] == "fail")

    def test_a_node_dies_and_a_disk_is_full(self):
        cluster_folder = self.folder / "cluster"
        cluster_folder.mkdir()
        cluster = Cluster(cluster_folder)
        self.addCleanup(cluster.stop)
        results = self.folder / "results"
        results.mkdir()
        clumsy = self.folder / "rubric"
        clumsy.write_text(RUBRIC_ON_A_FULL_DISK.format(shard=FULL_SHARD, rubric=RUBRIC))
        clumsy.chmod(0o755)
        cluster.environment["RUBRIC"] = str(clumsy)
        log = results / "log-%a.txt"
        cluster.ask("sbatch", f"--array=1-{SHARDS}", f"--output={log}",
                    str(ROOT / "tools/fleet/slurm"), str(self.captures), str(results))

        done = results / f"shard={DEAD_SHARD}-of-{SHARDS}/done.jsonl"
        cluster.until(lambda: done.exists() and done.read_bytes().count(b"\n") > 200)
        cluster.kill_node()
        judged = done.read_bytes().count(b"\n")
        self.assertFalse((done.parent / "results.jsonl").exists(), "it had ended before")
        cluster.start_node()

        def all_ended():
            cluster.begin_what_waits()
            return not cluster.ask("squeue", "-h")

        cluster.until(all_ended)
        logs = {task: pathlib.Path(str(log).replace("%a", str(task))).read_text()
                for task in range(1, SHARDS + 1)}
        known = re.search(r"\((\d+) known by --resume\)", logs[DEAD_SHARD])
        self.assertGreaterEqual(int(known[1]), judged, "a capture was judged twice")
        self.assertIn("cannot write", logs[FULL_SHARD])
        for shard in (DEAD_SHARD, FULL_SHARD):
            self.assertGreaterEqual(cluster.restarts()[shard], 1)

        files = [json.loads(line)["file"] for part in results.glob("shard=*/results.jsonl")
                 for line in part.read_text().splitlines()]
        self.assertEqual(sorted(files), sorted(map(str, self.captures.rglob("*.pcapng"))))
        self.assertEqual(len(files), COUNT)
        self.assert_failures(results)
        self.assert_refused(results)

    def assert_failures(self, results):
        """SQL finds what `rubric check` finds of each capture alone."""
        query = ["node", HERE / "query.mjs", ROOT / "tools/fleet/failures.sql", results]
        out = subprocess.run(query, check=True, capture_output=True, timeout=PATIENCE_S).stdout
        found = collections.Counter()
        for row in json.loads(out):
            found[row["day"], row["rule"]] = int(row["findings"])
            found[row["day"], row["rule"], "captures"] = int(row["captures"])
        self.assertEqual(found, self.expected)
        self.assertGreaterEqual(len({key[0] for key in found}), DAYS)

    def assert_refused(self, results):
        """Other shards would be counted beside those that are there."""
        for first, last in ((1, SHARDS + 1), (2, SHARDS)):
            done = subprocess.run(
                [ROOT / "tools/fleet/slurm", self.captures, results], check=False, text=True,
                capture_output=True, timeout=PATIENCE_S,
                env={**os.environ, "SLURM_ARRAY_TASK_MIN": str(first),
                     "SLURM_ARRAY_TASK_MAX": str(last), "SLURM_ARRAY_TASK_ID": str(last),
                     "SLURM_ARRAY_TASK_COUNT": str(last - first + 1)})
            self.assertEqual(done.returncode, 64)
            self.assertIn("without other shards", done.stderr)


if __name__ == "__main__":
    unittest.main()
