#!/usr/bin/env python3
"""Live captures by tshark with rubric-extcap, and `rubric install-wireshark`, which makes it known.

Usage: install_wireshark_test.py RUBRIC RUBRIC_EXTCAP. Needs tshark.
"""

import os
import pathlib
import re
import resource
import select
import shutil
import signal
import struct
import time
import unittest

from extcap_testing import EXTCAP, FORWARDER, PACKET, SERIAL, Base, decoded, run
from live_testing import Forwarder
from odd_specs import FLOATING, UNPROVED
from packets import radio
from serial_testing import PATIENCE_S, Pty, hdlc, read_until, wait_for
from testing import ROOT, RUBRIC

KAITAI = ROOT / "spec/kaitai_check"
CONFIG = pathlib.Path(".config/wireshark/extcap/rubric-extcap")


class Wireshark(Base):
    """The installed files in tshark."""

    def setUp(self):
        super().setUp()
        done = run(RUBRIC, "install-wireshark", env=self.environment)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def tshark(self, source, *more):
        fields = ("frame.encap_type", "rubric.path", "rubric.net_msg.seq_num", "rubric.fault",
                  "frame.interface_name")
        words = [word for field in fields for word in ("-e", field)]
        return self.started("tshark", "-l", "-i", "rubric", "-o", f"extcap.rubric.source:{source}",
                            "-T", "fields", "-E", "separator=|", "-E", "occurrence=f", *words,
                            *more)

    def lines(self, process, count):
        got, came = read_until(process.stdout.fileno(), lambda got: got.count(b"\n") >= count)
        if not came:
            process.kill()
            raise AssertionError(f"{got.count(10)} of {count} lines: {self.ended(process)}")
        return [line.split("|") for line in got.decode().splitlines()]

    def nothing_left(self, mark):
        """No process that was started for this source, no pipe in the temporary folder."""
        def ours():
            found = []
            for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
                try:
                    words = path.read_bytes().decode(errors="replace").split("\0")
                except OSError:
                    continue
                if mark in " ".join(words) and "rubric-extcap" in words[0]:
                    found.append(words)
            return found
        wait_for(lambda: not ours(), "the capture program has gone")
        self.assertEqual(list(self.folder.glob("wireshark_extcap*")), [])

    def test_it_is_listed(self):
        done = run("tshark", "-D", env=self.environment)
        self.assertRegex(done.stdout, r"(?m)^\d+\. rubric \(RUBICON mote or sink")
        self.assertNotRegex(done.stderr, "invalid|couldn't")
        done = run("tshark", "-i", "rubric", "-L", env=self.environment)
        self.assertIn("USER0", done.stdout)
        self.assertIn("USER1", done.stdout)

    def test_the_settings_are_known(self):
        done = run("tshark", "-G", "currentprefs", env=self.environment)
        for name in ("source", "othersource", "listenonly", "reconnect", "spec"):
            self.assertIn(f"#extcap.rubric.{name}:", done.stdout)

    def test_a_serial_forwarder(self):
        server = Forwarder(self)
        address = f"sf@127.0.0.1:{server.port}"
        process = self.tshark(address)
        connection = server.accept(FORWARDER.read_bytes())
        wanted = decoded(FORWARDER)
        lines = self.lines(process, len(wanted))  # While the source stays open.
        self.assertIsNone(process.poll())
        self.assertEqual([line[1] for line in lines], ["/".join(one["path"]) for one in wanted])
        self.assertEqual([line[2] for line in lines],
                         [str(one["fields"].get("seq_num", "")) for one in wanted])
        self.assertEqual({line[0] for line in lines}, {"46"})  # WTAP_ENCAP_USER1
        self.assertEqual({line[4] for line in lines}, {address})
        process.send_signal(signal.SIGINT)
        code, err = self.ended(process)
        self.assertEqual(code, 0, err)
        self.assertIn(f"{len(wanted)} packets captured", err)
        self.assertEqual(connection.recv(1), b"")
        self.nothing_left(address)

    def test_a_serial_line_by_tcp(self):
        server = Forwarder(self)
        address = f"network@127.0.0.1:{server.port}"
        process = self.tshark("", "-o", f"extcap.rubric.othersource:{address}", "-o",
                              "extcap.rubric.listenonly:true")
        connection = server.line()
        connection.sendall(hdlc(b"\x44\x2a" + PACKET))
        connection.sendall(hdlc(b"\x45" + PACKET, wrong=0x10))
        connection.sendall(SERIAL.read_bytes()[:3000])
        lines = self.lines(process, 20)
        self.assertEqual({line[0] for line in lines}, {"45"})  # WTAP_ENCAP_USER0
        self.assertEqual(lines[0][1], "config")
        self.assertEqual([line[3] for line in lines[:2]], ["", "crc"])
        wanted = decoded(SERIAL)[:18]
        self.assertEqual([line[1] for line in lines[2:20]],
                         ["/".join(one["path"]) for one in wanted])
        os.killpg(process.pid, signal.SIGINT)  # As Ctrl-C does it.
        code, err = self.ended(process)
        self.assertEqual(code, 0, err)
        self.assertEqual(connection.recv(1), b"")  # Nothing was confirmed.
        self.nothing_left(address)

    def test_a_serial_device_with_a_space_in_its_name(self):
        line = Pty(self)
        place = self.folder / "my mote"
        place.symlink_to(line.name)
        address = f"serial@{place}:micaz"
        process = self.tshark(address, "-f", "message==config", "-c", "1")
        confirmed = hdlc(b"\x43\x2a")
        got = b""
        deadline = time.monotonic() + PATIENCE_S
        while confirmed not in got and time.monotonic() < deadline:
            os.write(line.fd, hdlc(b"\x45\x00") + hdlc(b"\x44\x2a" + PACKET))
            if select.select([line.fd], [], [], 0.2)[0]:
                got += os.read(line.fd, 1000)
        self.assertEqual(self.lines(process, 1)[0][:2], ["45", "config"])
        self.assertEqual(self.ended(process)[0], 0)
        self.nothing_left(str(place))

    def test_mistakes_are_shown(self):
        for more, what in ((["-o", "extcap.rubric.source:serial@/no/such:micaz"],
                            "/no/such: cannot be opened"),
                           (["-f", "mesage"], "unknown name 'mesage'")):
            process = self.tshark("sf@127.0.0.1:1", *more)
            err = self.ended(process)[1]
            self.assertIn(what, err)
            self.assertIn("0 packets captured", err)

    def test_a_peer_that_goes(self):
        server = Forwarder(self)
        process = self.tshark(f"sf@127.0.0.1:{server.port}")
        server.accept(FORWARDER.read_bytes()).close()
        wanted = decoded(FORWARDER)
        self.assertEqual(len(self.lines(process, len(wanted))), len(wanted))
        self.assertIn("the other end closed it", self.ended(process)[1])


class Install(Base):
    def install(self, *words, code=0, program=None):
        done = run(program or RUBRIC, "install-wireshark", *words, env=self.environment)
        self.assertEqual(done.returncode, code, done)
        return done.stdout + done.stderr

    def tree(self):
        return sorted(str(path.relative_to(self.home)) for path in self.home.rglob("*")
                      if not path.is_dir())

    def test_where_tshark_says(self):
        folders = run("tshark", "-G", "folders", env=self.environment).stdout
        lua = re.search(r"Personal Lua Plugins:\s+(.*)", folders)[1]
        said = self.install("--dry-run")
        self.assertIn(f"would write {lua}/rubric.lua\n", said)
        self.assertEqual(self.tree(), [])
        for _ in range(2):
            said = self.install()
            self.assertIn(f"wrote {lua}/rubric.lua\n", said)
            self.assertEqual(len(self.tree()), 3)
        self.assertEqual(pathlib.Path(lua, "rubric.lua").read_bytes(),
                         (ROOT / "tools/wireshark/generated/rubric.lua").read_bytes())
        link = next(self.home.rglob("rubric-extcap"))
        self.assertEqual(os.path.realpath(link), os.path.realpath(EXTCAP))
        self.assertIn("removed", self.install("--remove"))
        self.assertEqual(self.tree(), [])
        self.assertIn("not there", self.install("--remove"))

    def told(self, spec, packets):
        """What tshark and `rubric decode` say of packets: Info, and the notes about text."""
        text = self.folder / "packets.hex"
        text.write_text("".join(one.hex() + "\n" for one in packets), encoding="utf-8")
        capture = self.folder / "packets.pcapng"
        run(RUBRIC, "convert", text, "-o", capture, "--spec", spec)
        done = run("tshark", "-r", capture, "-T", "fields", "-e", "_ws.col.Info", "-e",
                   "_ws.expert.message", env=self.environment)
        self.assertNotIn("Lua", done.stderr)
        wanted = run(RUBRIC, "decode", capture, "--spec", spec, "--color", "never", "--width",
                     "900")
        return ([line.split("\t") for line in done.stdout.splitlines()],
                [re.split(r" \* | !! ", line) for line in wanted.stdout.splitlines()
                 if not line.startswith("        ")])

    def packet(self, payload):
        return b"\0\xff\xff\0\2" + bytes([len(payload)]) + b"\x22\x64" + payload

    def test_text_is_shown_as_text(self):
        self.install("--spec", "printf")
        texts = [b"Hi!\n\0\0", b'say "it"\\\t', b"", "23 \u00b0C\r\n".encode(), b"half \xc3",
                 b"\xff\0x"]
        found, wanted = self.told("printf", map(self.packet, texts))
        self.assertEqual(len(found), len(texts))
        for (info, note), line in zip(found, wanted):
            self.assertEqual(info, re.sub(" +", " ", line[0][line[0].index("printf_msg"):]))
            self.assertEqual(note, line[1] if len(line) > 1 else "")
        self.assertIn('buffer="Hi!\\n"', found[0][0])
        self.assertIn("not_text at 13: buffer is not UTF-8, it has the byte 195", found[4][1])
        done = run("tshark", "-r", self.folder / "packets.pcapng", "-Y",
                   'rubric.printf_msg.buffer contains "Hi!"', env=self.environment)
        self.assertEqual(len(done.stdout.splitlines()), 1, done)

    def test_text_of_a_file(self):
        fields = ("{id: tag, type: str, size: 4, encoding: ASCII}",
                  "{id: name, type: strz, size: 6, encoding: ASCII}",
                  "{id: rest, type: str, size-eos: true, encoding: UTF-8, pad-right: 0x20}")
        spec = self.folder / "texts.ksy"
        text = ("meta: {id: texts, endian: be}\ntypes:\n  told:\n    -am-type: 100\n    seq:\n" +
                "".join(f"      - {one}\n" for one in fields))
        spec.write_text(text, encoding="utf-8")
        self.install("--spec", spec)
        found, wanted = self.told(spec, [self.packet(b"ABCDname\0xrest  "),
                                         self.packet(b"AB\xe9Dnamename.")])
        for (info, note), line in zip(found, wanted):
            self.assertEqual(info, re.sub(" +", " ", line[0][line[0].index("told"):]))
            self.assertEqual(note, line[1] if len(line) > 1 else "")
        # Of other encodings the bytes are shown, up to a terminator of two bytes at an even place.
        spec.write_text(text.replace("strz, size: 6, encoding: ASCII",
                                     "strz, encoding: UTF-16LE"), encoding="utf-8")
        self.install("--spec", spec)
        found, wanted = self.told(spec, [self.packet(b"ABCDx\0\0y\0\0zz"),
                                         self.packet(b"ABCDx\0y\0\0")])
        self.assertEqual(found[0][0], 'told tag="ABCD" name=780000790000 rest="zz"')
        self.assertIn('rest="zz"', wanted[0][0])
        self.assertIn("truncated at 17: name needs 7 bytes, the bytes end at 17", found[1][0])
        self.assertIn("truncated at 17: name needs 7 bytes, the bytes end at 17", wanted[1][-1])

    def test_bits_and_terminated_text_of_a_file(self):
        fields = ("{id: high, type: b3, enum: modes}", "{id: there, type: b1}",
                  "{id: wide, type: b12}", "{id: size, type: b4, valid: {max: 4}}",
                  "{id: last, type: b20}", "{id: name, type: strz}",
                  "{id: extra, type: u2, if: there}",
                  "{id: two, type: u1, if: 'high == modes::on'}",
                  "{id: part, size: size, if: there == true}",
                  "{id: line, terminator: 10, eos-error: false}")
        packets = [b"\xb1\x02\x21\x23\x45hi\0\x12\x34\x07AB\x0d\x0a..",
                   b"\xff\xff\x40\0\1\0\0\1",
                   b"\x0d\xff\4\1\2x\xff\0\0\1ABCDabc", b"\xa1\2\0\0\0no end", b"\x20\0\x50\0\0\0",
                   b"\x20\0\5\0\0\0", b"\x20", b"\x20\0\0\0"]
        for order in ("be", "le"):
            spec = self.folder / "bits.ksy"
            spec.write_text("meta: {id: bits, endian: be, encoding: UTF-8, bit-endian: " + order +
                            "}\ntypes:\n  told:\n    -am-type: 100\n    seq:\n" +
                            "".join(f"      - {one}\n" for one in fields) +
                            "enums: {modes: {5: on, 1: off}}\n", encoding="utf-8")
            self.install("--spec", spec)
            found, wanted = self.told(spec, [self.packet(one) for one in packets])
            self.assertEqual(len(found), len(packets))
            for (info, note), line in zip(found, wanted):
                line = [re.sub(r" \+\d+ stale$", "", one) for one in line]
                self.assertEqual(info.split(" !! ")[0],
                                 re.sub(" +", " ", line[0][line[0].index("told"):]))
                fault = " !! " in info
                self.assertEqual(note, re.sub(r" at \d+:", ":" if fault else r"\g<0>",
                                              line[1] if len(line) > 1 else ""))
            done = run("tshark", "-r", self.folder / "packets.pcapng", "-T", "fields", "-E",
                       "separator=,", "-e", "rubric.told.high", "-e", "rubric.told.wide", "-e",
                       "rubric.told.last", env=self.environment)
            table = run(RUBRIC, "decode", self.folder / "packets.pcapng", "--spec", spec,
                        "--format", "csv", "--fields", "high,wide,last")
            rows = table.stdout.replace("\r", "").splitlines()[1:]
            self.assertEqual(done.stdout.splitlines(), rows)

    def test_what_the_capture_cut_is_no_fault(self):
        spec = self.folder / "lamp.ksy"
        spec.write_text("meta: {id: lamp, endian: be}\ntypes:\n  light:\n    -am-type: 0x2a\n"
                        "    seq: [{id: node, type: u2}, {id: level, type: u1}]\n")
        self.install("--spec", spec)
        frame = radio(1, 0xFFFF, 5, 0x2A, b"\0\5\x50")
        head = struct.pack("<IHHIIII", 0xA1B2C3D4, 2, 4, 0, 0, len(frame) - 1, 230)
        records = b"".join(struct.pack("<IIII", 0, 0, len(frame) - 1, size) + frame[:-1]
                           for size in (len(frame), len(frame) - 1))
        (self.folder / "cut.pcap").write_bytes(head + records)
        done = run("tshark", "-r", self.folder / "cut.pcap", "-T", "fields", "-E", "separator=|",
                   "-e", "rubric.fault", "-e", "_ws.col.Info", env=self.environment)
        cut, short = (line.split("|") for line in done.stdout.splitlines())
        self.assertEqual(cut, ["", f"light node=5 * cut by the capture ({len(frame) - 1} of "
                                   f"{len(frame)} bytes)"])
        self.assertEqual(short[0], "truncated")

    def test_frames_on_the_radio_alone_with_a_header_of_their_own(self):
        spec = self.folder / "tide.ksy"
        carrier = ("meta: {id: tide, endian: be}\n-carrier: CARRIER\nseq:\n"
                   "  - {id: fcf, type: u2le, valid: 0x8841}\n  - {id: dsn, type: u1}\n"
                   "  - {id: pan, type: u2le}\n  - {id: dest, type: u2le}\n"
                   "  - {id: src, type: u2le, valid: 5}\n  - {id: kind, type: u1}\n"
                   "  - {id: payload, size-eos: true, type: {switch-on: kind, cases: {1: level}}}\n"
                   "types: {level: {seq: [{id: millimetres, type: s2}]}}\n")
        frame = radio(1, 0xFFFF, 5, 0, b"")[:9] + b"\1\xff\x38"
        head = struct.pack("<IHHIIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 230)
        (self.folder / "tide.pcap").write_bytes(
            head + struct.pack("<IIII", 0, 0, len(frame), len(frame)) + frame)
        for name, shows in (("radio_t", "-200||"),
                            ("serial", "||not_decoded: the protocol has no such frames")):
            spec.write_text(carrier.replace("CARRIER", name))
            self.install("--spec", spec)
            done = run("tshark", "-r", self.folder / "tide.pcap", "-T", "fields", "-E",
                       "separator=|", "-e", "rubric.level.millimetres", "-e", "rubric.fault", "-e",
                       "_ws.expert.message", env=self.environment)
            self.assertEqual((done.stdout.strip(), "Lua" in done.stderr), (shows, False))

    def test_what_varies_in_size(self):
        """Generated frames of plain Kaitai files: fields, faults and where notes are."""
        files = [(name, (KAITAI / f"{name}.ksy").read_text(encoding="utf-8"))
                 for name in ("plain", "lists", "computed", "wide")]
        for name, text in (*files, ("unproved", UNPROVED), ("floating", FLOATING)):
            text = re.sub("UTF-16LE|ISO-8859-15|windows-1252", "ASCII", text)
            spec = self.folder / f"{name}.ksy"
            spec.write_text(text, encoding="utf-8")
            made = run(RUBRIC, "generate", "--spec", spec, "--message", name, "--count", "1000",
                       "--valid", "0.5", "--seed", "7", "--format", "hex").stdout
            spec.write_text(text.replace("seq:", "-am-type: 100\nseq:", 1), encoding="utf-8")
            self.install("--spec", spec)
            packets = [self.packet(bytes.fromhex(line)) for line in made.splitlines()
                       if len(line) < 3 * 114]
            found, wanted = self.told(spec, packets)
            self.assertGreater(len(found), 250)
            for (info, said), line in zip(found, wanted, strict=True):
                parts = [re.sub(r" \+\d+ stale$", "", one) for one in line]
                shown, _, fault = info.partition(" !! ")
                fields = parts[0][parts[0].index(name):]
                self.assertEqual(*(re.sub(" +", " ", one).rstrip() for one in (shown, fields)))
                faults = [one for one in parts[1:]
                          if re.match("(truncated|trailing|out_of_range|unexpected) at", one)]
                self.assertEqual([fault] if fault else [], faults)
                notes = [one.split(":")[0] for one in parts[1:] if one not in faults]
                self.assertEqual(re.findall(r"\w+ at \d+(?=:)", said), notes)
            self.assertIn("!!", "".join(info for info, _ in found))

    def test_names_that_a_protocol_that_ships_has_for_other_things(self):
        spec = self.folder / "mine.ksy"
        spec.write_text("meta: {id: mine, endian: be, encoding: ASCII}\ntypes:\n"
                        "  time_sync_msg:\n    -am-type: 100\n    seq:\n"
                        "      - {id: root_id, type: strz}\n      - {id: node_id, type: part(2)}\n"
                        "      - {id: seq_num, type: u4}\n"
                        "  part: {params: [{id: n, type: u1}], seq: [{id: bytes, size: n}]}\n",
                        encoding="utf-8")
        self.install("--spec", spec)
        found, _ = self.told(spec, [self.packet(b"ABC\0\7\0\0\0\0\x09")])
        said = 'time_sync_msg root_id="ABC" node_id{bytes=0700} seq_num=9'
        self.assertEqual(found, [[said, ""]])
        for name, path in (("mine", self.folder / "packets.pcapng"),
                           ("TinyOS time synchronization (FTSP)", self.ftsp())):
            done = run("tshark", "-r", path, "-O", "rubric", "-o", f"rubric.protocol:{name}",
                       env=self.environment)
            self.assertNotIn("Lua Error", done.stdout)
            self.assertRegex(done.stdout, "(?m)^ +root_id: (ABC|7)$")
            self.assertRegex(done.stdout, "(?m)^ +seq_num: 9$")

    def ftsp(self):
        """A capture of one message of the protocol that ships."""
        capture = self.folder / "ftsp.pcapng"
        payload = bytes((0, 7, 0, 3, 9)) + bytes(4) + b"\x3e" + bytes(4)
        text = self.folder / "ftsp.hex"
        text.write_text((b"\0\xff\xff\0\2\x0e\x22\x3d" + payload).hex(), encoding="utf-8")
        run(RUBRIC, "convert", text, "-o", capture, "--spec", "ftsp")
        return capture

    def test_a_copy_of_what_ships_beside_the_file(self):
        """It is read in place of the one that ships, whether they differ or not."""
        wire = ROOT / "spec/wire"
        for added in ("", "# mine\n"):
            for name in ("tinyos", "oscilloscope"):
                text = (wire / f"{name}.ksy").read_text(encoding="utf-8") + added
                (self.folder / f"{name}.ksy").write_text(text, encoding="utf-8")
            spec = self.folder / "oscilloscope.ksy"
            self.install("--spec", spec)
            found, _ = self.told(spec, [b"\0\xff\xff\0\2\x1c\x22\x93" + bytes(28)])
            self.assertIn("oscilloscope_msg version=0", found[0][0])

    def test_a_protocol_that_does_not_ship(self):
        said = self.install("--spec", "prinft", code=64)
        self.assertIn("did you mean 'printf'?", said)

    def rules_of(self, capture):
        """The colouring rule of each packet."""
        done = run("tshark", "--color", "-r", capture, "-T", "fields", "-e",
                   "frame.coloring_rule.name", env=self.environment)
        self.assertNotIn("olor filter", done.stderr)
        return [line.removeprefix("Rubric: ") for line in done.stdout.splitlines()]

    def test_colouring_rules(self):
        """Faults, remarkable frames and acknowledgements have rules; Wireshark's and the user's
        stay."""
        capture = ROOT / "spec/captures/firmware/h4_stale_bytes.pcapng"
        self.install()
        rules = self.rules_of(capture)
        self.assertEqual([i + 1 for i, name in enumerate(rules)
                          if name == "a rule of the wire is broken"], [14, 16])
        self.assertEqual([rules[i - 1] for i in (3, 4, 10)],
                         ["acknowledgement", "acknowledgement", "remarkable"])
        path = next(self.home.rglob("colorfilters"))
        shipped = path.read_text(encoding="utf-8").split("\n", 3)[3]
        self.assertIn("@Bad TCP@", shipped)
        mine = "@mine@rubric@[65535,0,0][0,0,0]\n"
        path.write_text(path.read_text(encoding="utf-8").replace("@Rubric: rem", "!@Rubric: rem")
                        + mine, encoding="utf-8")
        self.install()
        self.assertEqual(path.read_text(encoding="utf-8").count("@Rubric: "), 3)
        self.assertIn("left alone", self.install())
        self.install("--remove")
        self.assertEqual(path.read_text(encoding="utf-8"), shipped + mine)
        self.assertIn("left alone", self.install("--remove"))

    def test_without_tshark(self):
        """Wiresharks since 4.2 look beside the plug-ins, older ones beside the configuration."""
        tools = self.folder / "tools"
        tools.mkdir()
        self.environment["PATH"] = f"{tools}:/bin"
        (tools / "tshark").write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
        (tools / "tshark").chmod(0o755)
        for said, extcap in (("Wireshark 4.0.17 (Git)", CONFIG), ("Wireshark 3.6.2", CONFIG),
                             ("Wireshark 4.4.1.", ".local/lib/wireshark/extcap/rubric-extcap"),
                             ("what?", ".local/lib/wireshark/extcap/rubric-extcap")):
            (tools / "wireshark").write_text(f"#!/bin/sh\necho '{said}'\n", encoding="utf-8")
            (tools / "wireshark").chmod(0o755)
            self.install()
            self.assertEqual(self.tree(), sorted([str(extcap),
                                                  ".local/lib/wireshark/plugins/rubric.lua"]))
            self.install("--remove")

    def test_a_newer_tshark(self):
        tools = self.folder / "tools"
        tools.mkdir()
        self.environment["PATH"] = f"{tools}:/bin"
        (tools / "tshark").write_text(
            "#!/bin/sh\nprintf 'Personal configuration:\\t%s\\n' \"$HOME/a\"\n"
            "printf 'Personal Lua Plugins: \\t%s\\n' \"$HOME/b c\"\n"
            "printf 'Personal Extcap path:\\t%s\\n' \"$HOME/d\"\n", encoding="utf-8")
        (tools / "tshark").chmod(0o755)
        self.install()
        self.assertEqual(self.tree(), ["b c/rubric.lua", "d/rubric-extcap"])

    def test_a_folder_of_choice(self):
        self.install("--dir", self.home / "w")
        self.assertEqual(self.tree(), ["w/extcap/rubric-extcap", "w/plugins/rubric.lua"])
        self.install("--dir", "", code=64)
        file = self.home / "w/plugins/rubric.lua"
        for folder in (file, file / "deeper"):
            for words in ([], ["--dry-run"]):
                said = self.install("--dir", folder, *words, code=74)
                self.assertIn(f"{file}: this is no folder", said)

    def test_files_of_others_stay(self):
        self.install("--dir", self.home)
        for name in ("plugins/rubric.lua", "extcap/rubric-extcap"):
            path = self.home / name
            for words in ([], ["--remove"], ["--dry-run"]):
                path.unlink()
                path.write_text("mine", encoding="utf-8")
                said = self.install("--dir", self.home, *words, code=74)
                self.assertIn(f"{path}: this is not ours", said)
                self.assertEqual(path.read_text(encoding="utf-8"), "mine")
            other = self.folder / "other"
            other.write_text("theirs", encoding="utf-8")
            path.unlink()
            path.symlink_to(other)
            self.install("--dir", self.home, code=74)
            self.install("--dir", self.home, "--force")
            self.assertEqual(other.read_text(encoding="utf-8"), "theirs")
        (self.home / "extcap/rubric-extcap").unlink()
        (self.home / "extcap/rubric-extcap").mkdir()
        self.assertIn("folder", self.install("--dir", self.home, "--force", code=74))

    def test_what_an_older_one_left_is_renewed(self):
        program = self.home / "extcap/rubric-extcap"
        program.parent.mkdir()
        program.symlink_to("/gone/rubric-extcap")
        self.install("--dir", self.home)
        self.assertEqual(os.path.realpath(program), os.path.realpath(EXTCAP))
        program.unlink()
        shutil.copy(EXTCAP, program)  # As where there are no links.
        self.install("--dir", self.home)
        self.assertTrue(program.is_symlink())

    def test_a_program_that_lacks_its_other_half(self):
        alone = self.folder / "alone"
        alone.mkdir()
        shutil.copy(RUBRIC, alone / "rubric")
        said = self.install("--dir", self.home, code=66, program=alone / "rubric")
        self.assertIn(f"{alone}/rubric-extcap: there is no such file", said)
        self.assertEqual(self.tree(), [])

    def test_the_program_itself_stays(self):
        """The program itself is in Wireshark's folder, where somebody may have put it."""
        folder = self.home / "extcap"
        folder.mkdir()
        for name, path in (("rubric", RUBRIC), ("rubric-extcap", EXTCAP)):
            shutil.copy(path, folder / name)
        whole = pathlib.Path(EXTCAP).read_bytes()
        for words in ([], ["--force"], ["--dry-run"], ["--remove"]):
            said = self.install("--dir", self.home, *words, code=74, program=folder / "rubric")
            self.assertIn(f"{folder}/rubric-extcap: this is the program itself", said)
        self.assertEqual(self.tree(), ["extcap/rubric", "extcap/rubric-extcap"])
        self.assertEqual((folder / "rubric-extcap").read_bytes(), whole)
        beside = self.folder / "programs"  # Whose rubric-extcap is a link to there.
        beside.mkdir()
        shutil.copy(RUBRIC, beside / "rubric")
        (beside / "rubric-extcap").symlink_to(folder / "rubric-extcap")
        said = self.install("--dir", self.home, code=74, program=beside / "rubric")
        self.assertIn("this is the program itself", said)
        self.assertEqual((folder / "rubric-extcap").read_bytes(), whole)

    def test_a_full_disk(self):
        """The old files stay, and no half-written ones."""
        def fill():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))

        self.install("--dir", self.home)
        dissector = self.home / "plugins/rubric.lua"
        dissector.write_text("-- Generated by rubricc from before\n", encoding="utf-8")
        tree = self.tree()
        done = run(RUBRIC, "install-wireshark", "--dir", self.home, env=self.environment,
                   preexec_fn=fill)
        self.assertEqual((done.returncode, done.stdout), (74, ""), done)
        self.assertIn("File too large", done.stderr)
        self.assertEqual(self.tree(), tree)
        self.assertEqual(dissector.read_text(encoding="utf-8"),
                         "-- Generated by rubricc from before\n")

    def test_without_home(self):
        tools = self.folder / "tools"
        tools.mkdir()
        self.environment["PATH"] = str(tools)
        del self.environment["HOME"]
        self.assertIn("$HOME is not set", self.install(code=66))


if __name__ == "__main__":
    unittest.main()
