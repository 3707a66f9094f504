#!/usr/bin/env python3
"""`rubric check` of runs that go on: lines in use, growing files, several at a time.

Usage: check_live_test.py RUBRIC. All of it on this host, bounded in time.
"""

import json
import os
import pty
import resource
import signal
import struct
import subprocess
import sys
import time
import unittest

from check_live_testing import (BROKEN_LINE, CLEAN_LINE, MANY, OPEN_LINE, SERIAL_TOO, STRAY_REPLY,
                                TWO_TAPS, CheckTest, blocks, data, frames_in, is_packet,
                                of_findings, offline, stamped, standing, until_packet)
# pylint: disable-next=unused-import
from live_testing import Forwarder, Running, load_tests  # noqa: F401
from serial_testing import PATIENCE_S, Pty, hdlc, holds, wait_for
from testing import rubric


class CheckLive(CheckTest):
    def test_a_failure_is_reported_while_the_line_is_open(self):
        kept = self.folder / "kept.pcapng"
        running, _ = self.served(data(BROKEN_LINE), "--format", "jsonl", "--write", kept)
        found = running.event("found", "J6-CONTENT")["finding"]
        self.assertEqual((found["severity"], found["frame"]), ("fail", 2))
        code, report, err = running.report()
        self.assertEqual((code, err), (1, ""))
        self.assertEqual(report["schema"], "rubric.check/1")
        self.assertEqual((code, report), offline(kept))
        self.assertIn(found, report["findings"])

    def test_as_text(self):
        kept = self.folder / "kept.pcapng"
        running, _ = self.served(data(BROKEN_LINE), "--write", kept)
        line = running.text("J6-CONTENT")
        self.assertRegex(line, r"^FAIL J6-CONTENT, sink of island 12, frame 2 at ")
        self.assertNotIn("Verdict", line)
        code, out, err = running.end()
        self.assertEqual((code, err), (1, ""))
        again = rubric("check", kept)[1]
        self.assertTrue(out.endswith("\n\n" + again) or out.endswith(again), out)
        self.assertIn(f"Again:    rubric check {kept}", out)

    def test_without_a_file_there_is_nothing_to_check_again(self):
        running, _ = self.served(data(BROKEN_LINE), "--verbose")
        said = running.text("J6-CONTENT")
        while "Allowed:" not in said:  # In full at once.
            said += running.text("\n")
        code, out, _ = running.end(signal.SIGTERM)
        self.assertEqual(code, 1)
        self.assertIn("Verdict: fail", out)
        self.assertNotIn("Again:", said + out)

    def test_documents_come_at_the_end(self):
        for form, start in (("json", "{"), ("junit", "<")):
            running, _ = self.served(data(BROKEN_LINE), "--format", form)
            running.text("FAIL J6-CONTENT", running.process.stderr)
            code, out, _ = running.end()
            self.assertEqual((code, out[0]), (1, start))
        where = self.folder / "report.json"
        running, _ = self.served(data(BROKEN_LINE), "--format", "json", "--out", where)
        running.text("FAIL J6-CONTENT")
        self.assertEqual(running.end()[0], 1)
        self.assertEqual(json.loads(where.read_text())["verdict"], "fail")

    def test_what_is_expected_is_reported_as_expected(self):
        known = self.folder / "known.yaml"
        known.write_text("- requirement: J6-CONTENT\n  message: serial_joined\n  reason: Old.\n")
        running, _ = self.served(data(BROKEN_LINE), "--expect", known)
        running.text("EXPECTED FAIL J6-CONTENT")
        code, out, _ = running.end()
        self.assertEqual(code, 0, out)

    def test_a_serial_line(self):
        for path, severity in ((CLEAN_LINE, None), (OPEN_LINE, "inconclusive")):
            line = Pty(self)
            kept = self.folder / f"{path.name}.pcapng"
            running = self.started(f"serial@{line.name}:telosb", "--format", "jsonl", "--write",
                                   kept)
            self.opened(running, line)
            content = data(path)
            for at in range(0, len(content), 1000):
                os.write(line.fd, content[at:at + 1000])
                time.sleep(0.01)
            if severity:
                found = running.event("found")["finding"]
                self.assertEqual(found["severity"], severity)
                self.assertIn("What hosts send down its serial line", found["text"])
            frames = frames_in(path)
            wait_for(lambda: frames_in(kept) > frames, kept)
            code, report, err = running.report()
            self.assertEqual(err, "")
            self.assertEqual((code, report), offline(kept))

    def test_frames_that_ask_for_it_are_confirmed(self):
        packet = bytes.fromhex("00ffff000003002514000c")
        for arguments, answer in (((), hdlc(b"\x43\x2a")), (("--listen-only",), b"")):
            line = Pty(self)
            kept = self.folder / "kept.pcapng"
            running = self.started(f"serial@{line.name}:115200", "--write", kept, *arguments)
            got = bytearray()

            def captured():
                os.write(line.fd, hdlc(b"\x44\x2a" + packet))
                got.extend(line.read(0.2))
                return kept.exists() and kept.stat().st_size > 150

            wait_for(captured, kept)
            got.extend(line.read(0.5))
            self.assertEqual(got[:len(answer)] if answer else got, answer)
            self.assertEqual(running.end()[2], "")
            kept.unlink()

    def test_a_file_that_grows(self):
        path = self.folder / "growing.pcapng"
        whole = data(STRAY_REPLY)
        request = until_packet(whole, 1)
        path.write_bytes(whole[:request])
        running = self.started(path, "--follow", "--format", "jsonl")
        # Nothing comes, and the missing reply is reported.
        silent = running.event("found", "J3-REPLY")["finding"]
        self.assertEqual((silent["severity"], silent["frame"]), ("inconclusive", 1))
        with open(path, "ab", buffering=0) as file:
            for at in range(request, len(whole), 11):
                file.write(whole[at:at + 11])
        found = running.event("found", "J4-SEQ")["finding"]
        code, report, err = running.report()
        self.assertEqual((code, err), (1, ""))
        self.assertEqual((code, report), offline(path))
        self.assertIn(found, report["findings"])

    def test_what_turns_out_otherwise_is_withdrawn(self):
        path = self.folder / "growing.pcapng"
        whole = data(TWO_TAPS)
        request = until_packet(whole, 1)
        path.write_bytes(whole[:request])
        running = self.started(path, "--follow", "--format", "jsonl")
        running.event("found", "J3-REPLY")
        with open(path, "ab") as file:
            file.write(whole[request:])
        gone = running.event("withdrawn", "J3-REPLY")
        self.assertTrue(gone["why"])
        code, report, _ = running.report()
        self.assertEqual((code, report), offline(path))
        self.assertNotIn("J3-REPLY", [one["requirement"] for one in report["findings"]])

    def test_what_is_reported_live_is_in_the_last_report(self):
        for capture in (MANY, SERIAL_TOO):
            path = self.write(capture.name, b"")
            wanted = of_findings(offline(capture)[1]["findings"])
            wanted = {(str(path), *rest): severity for (_, *rest), severity in wanted.items()}
            self.assertTrue(wanted)
            running = self.started(path, "--follow", "--format", "jsonl")
            content = data(capture)
            with open(path, "ab", buffering=0) as file:
                for at in range(0, len(content), len(content) // 20):
                    file.write(content[at:at + len(content) // 20])
                    time.sleep(0.1)
            while standing(running.seen) != wanted:
                running.seen += running.lines(1)
            code, report, _ = running.report()
            self.assertEqual((code, report), offline(path))

    def test_a_device_that_is_unplugged(self):
        line = Pty(self)
        kept = self.folder / "kept.pcapng"
        running = self.started(f"serial@{line.name}:telosb", "--write", kept)
        self.opened(running, line)
        line.close()
        code, out, err = running.end(None)
        self.assertEqual(code, 66)
        self.assertIn("the line broke", err)
        self.assertIn("Verdict: ", out)
        self.assertTrue(offline(kept)[1]["schema"])

    def test_files_that_become_others(self):
        whole = data(TWO_TAPS)
        for change, said in (("shorten", "it has become shorter"),
                             ("replace", "another file has taken its name"),
                             ("remove", "it was renamed or deleted")):
            path = self.write(f"{change}.pcapng", whole)
            running = self.started(path, "--follow")
            wait_for(lambda it=running.process, p=path: holds(it, p), path)
            if change == "shorten":
                path.write_bytes(whole[:100])
            elif change == "replace":
                other = self.write("other.pcapng", whole)
                other.rename(path)
            else:
                path.unlink()
            code, out, err = running.end(None)
            self.assertIn(f"rubric: {path}: {said}", err)
            self.assertIn("Verdict: ", out)
            self.assertEqual(code, 66)

    def test_radio_and_serial_at_once(self):
        capture = list(blocks(data(TWO_TAPS)))
        line = Pty(self)
        sniffer = self.folder / "sniffer.pcapng"
        kept = self.folder / "kept.pcapng"
        sniffer.write_bytes(b"".join(block for block in capture if not is_packet(block)))
        running = self.started(f"serial@{line.name}:telosb", sniffer, "--follow", "--write", kept,
                               "--format", "jsonl", "--listen-only")
        line.opened(running.process)
        packets = [block for block in capture if is_packet(block)]
        first_us = struct.unpack_from("<I", packets[0], 16)[0]
        start = time.time()
        with open(sniffer, "ab", buffering=0) as file:
            for block in packets:
                interface, high, low, size = struct.unpack_from("<IIII", block, 8)
                at = ((high << 32) + low - first_us) / 1e6
                time.sleep(max(0, start + at - time.time()))
                if interface == 0:
                    file.write(stamped(block, int(start * 1e6) - first_us))
                else:
                    os.write(line.fd, hdlc(block[28:28 + size - 2]))
        frames = len(packets)
        wait_for(lambda: frames_in(kept) > 0, kept)
        code, report, err = running.report()
        self.assertEqual((code, report), offline(kept, sniffer), err)
        self.assertEqual(report["files"], [str(kept), str(sniffer)])
        self.assertGreater(report["counts"]["frames"], frames // 2)
        self.assertEqual(report["counts"]["fail"], 0)

    def test_a_line_that_breaks(self):
        running, connection = self.served(data(BROKEN_LINE), "--format", "jsonl")
        running.event("found", "J6-CONTENT")
        connection.close()
        code, report, err = running.report(None)
        self.assertEqual((code, report["verdict"]), (1, "fail"))
        self.assertIn("the line broke: the other end closed it", err)
        running, connection = self.served(data(BROKEN_LINE)[:2])
        connection.close()
        self.assertEqual(running.end(None)[0], 66)

    def test_a_line_that_comes_back(self):
        server = Forwarder(self)
        running = self.started(f"sf@127.0.0.1:{server.port}", "--reconnect", "--format", "jsonl")
        server.accept(b"U ").close()
        server.accept(data(BROKEN_LINE))
        self.assertEqual(running.event("found", "J6-CONTENT")["finding"]["frame"], 2)
        code, _, err = running.report()
        self.assertEqual(code, 1)
        self.assertIn("the other end closed it", err)
        self.assertIn("again", err)

    def test_a_reader_that_has_seen_enough(self):
        running, _ = self.served(data(BROKEN_LINE))
        running.text("J6-CONTENT")
        running.process.stdout.close()
        self.assertEqual(running.process.wait(PATIENCE_S), 74)
        self.assertEqual(running.process.stderr.read(), b"")

    def test_a_pipe(self):
        running = self.started("-", "--follow", "--format", "jsonl", stdin=subprocess.PIPE)
        self.addCleanup(running.process.stdin.close)
        running.process.stdin.write(data(STRAY_REPLY))
        running.process.stdin.flush()
        running.event("found", "J4-SEQ")
        code, report, err = running.report()
        self.assertEqual((code, report["files"], err), (1, ["stdin"], ""))

    def test_a_pipe_that_ends(self):
        for words in (("check", "--format", "json"), ("decode",), ("stats",)):
            self.shows((words[0], "-", "--follow", *words[1:]),
                       "50421" if words[0] == "decode" else "frames", code=words[0] == "check",
                       stdin=data(STRAY_REPLY), timeout=PATIENCE_S)

    def test_a_named_pipe(self):
        path = self.folder / "sniffed"
        os.mkfifo(path)
        running = self.started(path, "--follow", "--format", "jsonl")
        with open(path, "wb") as file:
            file.write(data(STRAY_REPLY))
        running.event("found", "J4-SEQ")
        code, report, err = running.report()
        self.assertEqual((code, report["files"], err), (1, [str(path)], ""))

    def test_a_named_pipe_that_nobody_writes_to(self):
        path = self.folder / "sniffed"
        os.mkfifo(path)
        running = self.started(path, "--follow", "--format", "jsonl")
        wait_for(lambda: holds(running.process, path), path)
        code, report, err = running.report()
        self.assertEqual((code, report["findings"], err), (3, [], f"rubric: {path}: is empty\n"))

    def test_a_wish_that_comes_as_two_signals(self):
        running = self.started("-", "--follow", "--format", "jsonl", stdin=subprocess.PIPE)
        self.addCleanup(running.process.stdin.close)
        running.process.stdin.write(data(STRAY_REPLY))
        running.process.stdin.flush()
        running.event("found", "J4-SEQ")
        running.process.send_signal(signal.SIGTERM)  # As `timeout` does it.
        self.assertEqual(running.report(signal.SIGTERM)[0], 1)

    def test_stats_of_a_line(self):
        server = Forwarder(self)
        running = Running("stats", f"sf@127.0.0.1:{server.port}", "--format", "json")
        connection = server.accept(data(BROKEN_LINE))
        time.sleep(1)
        connection.close()
        code, out, err = running.end(None)
        self.assertEqual((code, json.loads(out)["frames"]), (66, 2), err)
        path = self.write("whole.pcapng", data(TWO_TAPS))
        running = Running("stats", path, "--follow", "--format", "json")
        wait_for(lambda: holds(running.process, path), path)
        time.sleep(0.5)
        code, out, err = running.end()
        self.assertEqual((code, json.loads(out)["frames"], err), (0, 11, ""))

    def test_motecom(self):
        server = Forwarder(self)
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        running = self.started("--format", "jsonl", stdin=slave,
                               env={**os.environ, "MOTECOM": f"sf@127.0.0.1:{server.port}"})
        os.close(slave)
        server.accept(data(BROKEN_LINE))
        running.event("found", "J6-CONTENT")
        self.assertEqual(running.report()[0], 1)

    def test_options_that_make_no_sense(self):
        log = self.write("run.rtr", "%rtr 1\n")
        line = "sf@127.0.0.1:1"
        for arguments, said in (
                (("x.pcapng", "--write", "y.pcapng"), "none of the sources is a line in use"),
                (("x.pcapng", "--follow", "--write", "y.pcapng"), "none of the sources is a line"),
                ((line, "--frames", "1..2"), "--frames"),
                ((line, log), "is a log"),
                ((line, line), "is there twice"),
                ((line, "--write", "y", "--out", "y"), "is also an input or another output"),
                (("serial@/dev/ttyUSB0",), "expected serial@DEVICE:BAUD"),
                ((), "FILE")):
            self.refused(("check", *arguments), said)

    def test_a_long_run_is_judged_in_little_of_the_time(self):
        """Frames as fast as they go: what is judged again and again must not add up."""
        path = self.folder / "long.pcapng"
        rubric("simulate", "--motes", 20, "--sinks", 2, "--seconds", 700, "--out-pcapng", path)
        whole = path.read_bytes()
        growing = self.write("growing.pcapng", b"")
        begin = time.monotonic()
        running = self.started(growing, "--follow", "--format", "jsonl", "--start", "cold")
        with open(growing, "ab", buffering=0) as file:
            for at in range(0, len(whole), len(whole) // 40):
                file.write(whole[at:at + len(whole) // 40])
                time.sleep(0.1)
        fed = time.monotonic() - begin
        time.sleep(2)
        running.process.send_signal(signal.SIGINT)
        out = running.process.stdout.read()
        _, status, usage = os.wait4(running.process.pid, 0)
        running.process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - begin
        code, report = offline(path, "--start", "cold")
        got = json.loads(out.splitlines()[-1])["report"]
        self.assertEqual(running.process.returncode, code)
        self.assertGreater(got["counts"]["frames"], 30000)
        self.assertEqual(got["counts"], report["counts"])
        busy = usage.ru_utime + usage.ru_stime
        if os.environ.get("RUBRIC_MEASURE"):
            print(f"{got['counts']['frames']} frames fed in {fed:.1f} s; {busy:.2f} of "
                  f"{wall:.1f} s of CPU, {usage.ru_maxrss // 1024} MB", file=sys.stderr)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        offline(path, "--start", "cold")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        once = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.assertLess(busy, 0.3 * wall + 3 * once)


if __name__ == "__main__":
    unittest.main()
