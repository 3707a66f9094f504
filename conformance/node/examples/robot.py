#!/usr/bin/env python3
"""A robot's channel: `rubric run islands.yaml` runs this as the application of both its ends.

robot.py drive        a mote on a robot, which sends its way to its sink through a channel
robot.py watch 11:8   the sink, which says on stderr what comes from there
"""

import itertools
import json
import sys
import threading
import time


def call(**what):
    print(json.dumps(what), flush=True)


def drive(channel):
    for metres in itertools.count():
        call(call="write_output", channel=channel, pos=0, value=metres / 4)
        time.sleep(0.5)


def robot(event):
    if event["event"] == "joined":
        if event["success"]:
            island = event["own"].split(":")[0]
            call(call="create_out", dest=f"{island}:1", size=1, power_save=False)
        else:
            call(call="join", type=1, transducers=0, actuators=0)
    elif event["event"] == "channel_result":
        call(call="start", channel=event["channel"])
        threading.Thread(target=drive, args=(event["channel"],), daemon=True).start()


def sink(event):
    if event["event"] == "channel_result":
        call(call="start", channel=event["channel"])
    elif event["event"] == "syn_data" and event["status"] == "new":
        call(call="read_input", channel=event["channel"], pos=0)
    elif event["event"] == "input_value":
        print(f"the robot has come {event['value']} m", file=sys.stderr, flush=True)


if sys.argv[1] == "drive":
    call(call="join", type=1, transducers=0, actuators=0)
else:
    call(call="create_in", src=sys.argv[2], size=1, power_save=False)
for line in sys.stdin:
    (robot if sys.argv[1] == "drive" else sink)(json.loads(line))
