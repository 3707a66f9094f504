#!/usr/bin/env python3
"""`rubric send` to a sink in QEMU, which confirms and answers as a mote on a desk does.

Usage: arm_send_test.py FIRMWARE_ARM SINK_ELF RUBRIC.
"""

import json
import subprocess
import sys

from arm_serial_test import serve

ISLAND, SINK, PC = 12, 1, 0xFFFD
CONNLESS, MOCKUP, RUBICON_ACK = 3, 5, 9
RETRIES = "60"  # Of 1 s each: a machine may be busy.


def send(to, message, fields, *arguments):
    """Sends a message, prints the output, and returns stdout."""
    done = subprocess.run([sys.argv[3], "send", "--to", to, "--as", message, "--dest", "1",
                           "--retries", RETRIES, *arguments], input=json.dumps(fields) + "\n",
                          capture_output=True, text=True, check=False)
    print(done.stdout + done.stderr)
    if done.returncode != 0 or "1 packet, 1 confirmed" not in done.stderr:
        raise SystemExit(f"rubric send ended with {done.returncode}")
    return done.stdout


def talk(to):
    """A new island id, and a reliable message that is acked from there."""
    send(to, "config", {"type": 10, "value": ISLAND})
    demo = {"msg_type": 1, "sensors_bitmask": 3, "period": 0x7E7D}
    message = {"dest": {"pid": ISLAND, "devid": SINK}, "src": {"pid": ISLAND, "devid": PC},
               "reliable": 1, "seq_num": 77,
               "payload": {"trans_id": CONNLESS, "app_id": MOCKUP, "body": demo}}
    out = send(to, "net_msg", message, "--listen", "5", "--format", "jsonl")
    acks = [json.loads(line) for line in out.splitlines()]
    acks = [one["fields"] for one in acks if one["message"] == "rubicon_ack"]
    if not acks or any((ack["src"]["pid"], ack["src"]["devid"]) != (ISLAND, SINK) or
                       ack["payload"]["app_id"] != MOCKUP for ack in acks):
        raise SystemExit(f"no ack of the message among what was answered: {out}")


def main():
    def over(line):
        kind, _, rest = line.partition(":")
        talk(f"network@{rest}" if kind == "tcp" else f"serial@{line}:115200")

    serve("--serial-tcp", over)
    serve("--serial-device", over)


if __name__ == "__main__":
    main()
