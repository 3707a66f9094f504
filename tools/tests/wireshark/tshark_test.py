#!/usr/bin/env python3
"""Wireshark's tshark reads what `rubric convert` wrote: an independent reader of our writers.

Usage: tshark_test.py RUBRIC. Compares what tshark says of a written file with what it says of
the source, and against the records beside the captures, which no reader of ours has touched.
"""

import json
import pathlib
import subprocess
import tempfile
import unittest

from testing import FIRMWARE, run

CAPTURES = pathlib.Path("spec/captures")
BASE_STATION = CAPTURES / "basestation"

# tshark's numbers of the link types IEEE802_15_4_WITHFCS, USER0 and USER1.
RADIO, SERIAL, SF = "104", "45", "46"


def tshark(path):
    """A dict for each packet, as Wireshark's dissectors see it."""
    # As root tshark warns on stderr, which says nothing about the file.
    said = subprocess.run(["tshark", "-r", str(path), "-T", "json", "-x", "-J", "frame wpan"],
                          capture_output=True, check=False)
    assert said.returncode == 0, f"tshark cannot read {path.name}: {said.stderr.decode()}"
    return [described(packet["_source"]["layers"]) for packet in json.loads(said.stdout)]


def described(layers):
    frame = layers["frame"]
    packet = {
        "raw": layers["frame_raw"][0] if "frame_raw" in layers else "",
        "size": int(frame["frame.len"]),
        "captured": int(frame["frame.cap_len"]),
        "time": frame.get("frame.time_epoch"),  # None: its block has no stamp.
        "link": frame["frame.encap_type"],
        "interface": frame.get("frame.interface_id_tree", {}).get("frame.interface_name"),
        "direction": frame.get("frame.packet_flags_tree", {}).get("frame.packet_flags_direction"),
    }
    packet["wpan"] = {key: value for key, value in layers.get("wpan", {}).items()
                      if not key.endswith("_raw") and not isinstance(value, dict)}
    return packet


def without(packets, *keys):
    return [{key: packet[key] for key in packet if key not in keys} for packet in packets]


def rows(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def unescaped(hdlc):
    """The content of one serial frame between its flags (TEP 113, section 3.1)."""
    out = bytearray()
    escaped = False
    for byte in bytes.fromhex(hdlc).strip(b"\x7e"):
        if byte == 0x7d and not escaped:
            escaped = True
            continue
        out.append(byte ^ 0x20 if escaped else byte)
        escaped = False
    return out.hex()


def microseconds(time):
    seconds, fraction = time.split(".")
    return int(seconds) * 1_000_000 + int(fraction) // 1000


class Tshark(unittest.TestCase):
    maxDiff = 4000

    @classmethod
    def setUpClass(cls):
        cls.said = {}  # The tests share most files, and tshark takes its time to start.
        cls.folder = tempfile.TemporaryDirectory(prefix="rubric-tshark-")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def target(self, name):
        return pathlib.Path(self.folder.name) / name

    def convert(self, source, name, *arguments):
        target = self.target(name)
        run("convert", *arguments, source, "-o", target, check=True)
        return target

    def source(self, path):
        if path not in self.said:
            self.said[path] = tshark(path)
        return self.said[path]

    def converted(self, source, name, *arguments):
        """Returns tshark's output for the source as rubric writes it."""
        key = (source, name, *arguments)
        if key not in self.said:
            self.said[key] = tshark(self.convert(source, name, *arguments))
        return self.said[key]

    def test_a_pcapng_of_a_pcapng_says_the_same(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                source = self.source(path)
                self.assertEqual(self.converted(path, "out.pcapng"), source)
                self.assertEqual({packet["captured"] - packet["size"] for packet in source}, {0})
                compared += len(source)
        self.assertGreater(compared, 500)

    def test_a_pcap_of_a_pcapng_says_the_same_but_for_interface_and_direction(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            for framing, link in (("radio", RADIO), ("hdlc", SERIAL)):
                with self.subTest(f"{path.name} {framing}"):
                    wanted = [packet for packet in self.source(path) if packet["link"] == link]
                    if not wanted:
                        continue
                    found = self.converted(path, "out.pcap", "--only", framing)
                    self.assertEqual(without(found, "interface", "direction"),
                                     without(wanted, "interface", "direction"))
                    compared += len(found)
        self.assertGreater(compared, 500)

    def test_radio_frames_are_what_the_firmware_sent(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                packets = [packet for packet in self.converted(path, "out.pcapng")
                           if packet["link"] == RADIO]
                self.assertEqual({packet["wpan"]["wpan.fcs_ok"] for packet in packets}, {"1"})
                self.assertEqual({packet["interface"] for packet in packets}, {"radio"})
                # Acknowledgements have no address and no record of their own.
                data = [packet for packet in packets if "wpan.src16" in packet["wpan"]]
                found = sorted((microseconds(packet["time"]),
                                int(packet["wpan"]["wpan.src16"], 16),
                                int(packet["wpan"]["wpan.dst16"], 16),
                                int(packet["wpan"]["wpan.dst_pan"], 16),
                                int(packet["wpan"]["wpan.seq_no"]),
                                packet["raw"][22:-4]) for packet in data)
                sent = sorted((row["t_us"], row["src"], row["dst"], row["group"], row["dsn"],
                               row["payload"])
                              for row in rows(path.with_suffix(".radio.jsonl"))
                              if row["dir"] in ("tx", "inj"))
                self.assertEqual(found, sent)
                compared += len(found)
        self.assertGreater(compared, 300)

    def test_serial_frames_of_captures_are_what_was_on_the_line(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.pcapng")):
            with self.subTest(path.name):
                found = [(packet["raw"], microseconds(packet["time"]), packet["interface"],
                          int(packet["direction"], 16))
                         for packet in self.converted(path, "out.pcapng")
                         if packet["link"] == SERIAL]
                wanted = [(unescaped(row["hdlc"]), row["t_us"], f"serial:{row['node']}",
                           1 if row["dir"] == "serial_in" else 2)
                          for row in rows(path.with_suffix(".sf.jsonl"))]
                self.assertEqual(found, wanted)
                compared += len(found)
        self.assertGreater(compared, 200)

    def assert_stream(self, path, raw, link):
        for suffix in ("pcapng", "pcap"):
            with self.subTest(f"{path.name} to {suffix}"):
                packets = self.converted(path, f"out.{suffix}")
                self.assertEqual([packet["raw"] for packet in packets], raw)
                self.assertEqual([packet["size"] for packet in packets],
                                 [len(packet) // 2 for packet in raw])
                self.assertEqual({packet["link"] for packet in packets}, {link})
                # A stream knows neither; nothing must be made up.
                self.assertEqual({packet["direction"] for packet in packets}, {None})
                times = {packet["time"] and float(packet["time"]) for packet in packets}
                self.assertEqual(times, {None if suffix == "pcapng" else 0.0})

    def test_serial_streams_are_what_was_on_the_line(self):
        compared = 0
        for path in sorted(FIRMWARE.glob("*.bin")):
            name, *middle, direction, _ = path.name.split(".")
            node = int(middle[0].removeprefix("node")) if middle else 1
            wanted = "serial_in" if direction == "serial_in" else "serial_out"
            raw = [unescaped(row["hdlc"]) for row in rows(FIRMWARE / f"{name}.sf.jsonl")
                   if row["dir"] == wanted and row["node"] == node]
            self.assert_stream(path, raw, SERIAL)
            compared += len(raw)
        self.assertGreater(compared, 200)

    def test_serial_forwarder_streams_are_what_was_sent(self):
        compared = 0
        for path in sorted(BASE_STATION.glob("*.sfstream")):
            name, direction, _ = path.name.split(".")
            raw = [row["hex"] for row in rows(BASE_STATION / f"{name}.sf.jsonl")
                   if row["dir"] == direction]
            self.assert_stream(path, raw, SF)
            compared += len(raw)
        self.assertGreater(compared, 60)

    def test_nanoseconds_survive(self):
        """The captures count microseconds; a file that counts more finely loses nothing."""
        source = self.target("fine.pcapng")
        line = run("decode", FIRMWARE / "a_join_data.pcapng", "--format", "jsonl", "--count", 1,
                   check=True).stdout
        record = json.loads(line)
        record["time"] = 1700000000.123456789
        text = json.dumps(record).replace(json.dumps(record["time"]), "1700000000.123456789")
        run("encode", "--format", "pcapng", "-o", source, input=text.encode(), check=True)
        for name in ("out.pcapng", "out.pcap"):
            times = [packet["time"] for packet in self.converted(source, name)]
            self.assertEqual(times, ["1700000000.123456789"])

    def test_tshark_sees_a_wrong_fcs(self):
        """That all are right above means something: one bit flipped is seen."""
        target = self.convert(FIRMWARE / "a_join_data.pcapng", "bad.pcap", "--only", "radio")
        data = bytearray(target.read_bytes())
        data[-1] ^= 1  # The last byte of the last packet's FCS.
        target.write_bytes(data)
        packets = tshark(target)
        self.assertEqual(packets[-1]["wpan"]["wpan.fcs_ok"], "0")
        self.assertEqual({packet["wpan"]["wpan.fcs_ok"] for packet in packets[:-1]}, {"1"})
        again = self.converted(target, "again.pcapng")
        self.assertEqual(without(again, "interface"), without(packets, "interface"))


if __name__ == "__main__":
    unittest.main()
