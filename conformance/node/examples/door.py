#!/usr/bin/env python3
"""A mote with a door: rubric run islands.yaml runs it as `app: python3 door.py`."""

import json
import sys


def call(**what):
    print(json.dumps(what), flush=True)


call(call="join", type=1, transducers=0, actuators=2)
for line in sys.stdin:
    event = json.loads(line)
    if event["event"] == "joined" and not event["success"]:
        call(call="join", type=1, transducers=0, actuators=2)
    if event["event"] == "received" and bytes.fromhex(event["data"]) == b"OPEN_DOOR":
        call(call="send", dest=event["src"], app_id=10, reliable=True, data=b"DOOR_IS_OPEN".hex())
