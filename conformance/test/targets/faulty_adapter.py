"""An adapter that is good but for one fault.

Usage: faulty_adapter.py FAULT FLAG ADAPTER. Passes everything to the program ADAPTER, until the
fault happens. Removes the file FLAG, which says that this run is to be the faulty one. What it
does when nothing is asked it does once there is a file FLAG.now, and says so by its process id in
FLAG.done.
"""

import os
import re
import signal
import subprocess
import sys
import threading
import time

FAULT, FLAG, ADAPTER = sys.argv[1:]
HELLO = {
    "newer_version": "hello rct/2 thing 1 roles=mote time=virtual",
    "no_version": "hello thing 1 roles=mote",
    "no_roles": "hello rct/1 thing 1 time=virtual",
    "unknown_role": "hello rct/1 thing 1 roles=mote,toaster",
    "no_name": "hello rct/1",
    "http": "HTTP/1.1 400 Bad Request",
    "refused_hello": "unsupported hello",
}


def put(data):
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


def sleep():
    time.sleep(1000)


def flood(line):
    while True:
        put(line * 1000)


def ignore_term():
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sleep()


def leave_child():
    """Ends, while a child keeps standard output open."""
    if os.fork() == 0:
        sleep()
    os._exit(0)


def last_words():
    sys.stderr.write("out of cheese\n")
    sys.stderr.flush()
    os._exit(3)


def close_output():
    os.close(1)
    sleep()


def close_input():
    os.close(0)  # Before the answer: the next command finds nobody.
    put(b"done 0\n")
    sleep()


FAULTS = {
    "killed": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "crashed": os.abort,
    "stopped": lambda: os.kill(os.getpid(), signal.SIGSTOP),
    "hung": sleep,
    "hung_ignoring_sigterm": ignore_term,
    "half_a_line": lambda: (put(b"don"), sleep()),
    "half_a_line_then_end": lambda: (put(b"don"), os._exit(0)),
    "long_line": lambda: (put(b"x" * 10_000_000 + b"\n"), sleep()),
    "endless_line": lambda: flood(b"x"),
    "not_utf8": lambda: put(b"note \xc3\x28\n"),
    "nul_bytes": lambda: put(b"done\0 0\n"),
    "carriage_return": lambda: put(b"done 0\r\n"),
    "exit_with_words": last_words,
    "exit_0": lambda: os._exit(0),
    "child_keeps_output": leave_child,
    "closed_output": close_output,
    "closed_input": close_input,
    "garbage": lambda: put(b"lorem ipsum dolor\n"),
    "empty_line": lambda: put(b"\n"),
    "endless_notes": lambda: flood(b"note again\n"),
    "endless_frames": lambda: flood(b"tx 0 radio 000001000506000e03e802000701\n"),
    "done_before_its_time": lambda: put(b"done 99999999\n"),
    "bad_hex": lambda: put(b"tx 0 radio 0000zz\n"),
    "ready_again": lambda: put(b"ready\n"),
    "unknown_event": lambda: put(b"up 0 exploded(1)\n"),
}

UNASKED = {
    "speaks_unasked": lambda: put(b"note by the way\n"),
    "half_a_line_unasked": lambda: put(b"note"),
    "ends_unasked": lambda: None,
}
AT_RESET = {
    "ends_at_reset": lambda: os._exit(5),
    "hangs_at_reset": sleep,
    "babbles_at_reset": lambda: put(b"done 0\n"),
}
AT_BYE = {
    "bad_status_at_bye": lambda: os._exit(7),
    "killed_at_bye": lambda: os.kill(os.getpid(), signal.SIGKILL),
    "speaks_at_bye": lambda: put(b"done\n"),
    "hangs_at_bye": sleep,
}


def act_unasked():
    while not os.path.exists(FLAG + ".now"):
        time.sleep(0.002)
    sys.stderr.write("last words\n")
    sys.stderr.flush()
    UNASKED[FAULT]()
    with open(FLAG + ".done.new", "w") as file:
        file.write(str(os.getpid()))
    os.rename(FLAG + ".done.new", FLAG + ".done")
    if FAULT == "ends_unasked":
        os._exit(7)


def main():
    os.remove(FLAG)
    if FAULT in UNASKED:
        threading.Thread(target=act_unasked, daemon=True).start()
    inner = subprocess.Popen([ADAPTER], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for line in sys.stdin.buffer:
        word = line.split()[0]
        if FAULT in HELLO and word == b"hello":
            put(HELLO[FAULT].encode() + b"\n")
            continue
        if word in (b"call", b"rx") and FAULT in FAULTS:
            FAULTS[FAULT]()
            sleep()
        if word == b"reset" and FAULT in AT_RESET:
            AT_RESET[FAULT]()
            sleep()
        if word == b"until" and FAULT == "refuses_time":
            put(b"unsupported time\n")
            continue
        if word == b"bye" and FAULT in AT_BYE:
            sys.stderr.write("last words\n")
            sys.stderr.flush()
            AT_BYE[FAULT]()
        inner.stdin.write(line)
        inner.stdin.flush()
        if word == b"bye":
            sys.exit(inner.wait())
        answer = b""
        closed = False
        while not closed:
            one = inner.stdout.readline()
            answer += one
            closed = one.split()[:1][0] in (b"hello", b"ready", b"done", b"unsupported")
        if FAULT == "false_next":
            answer = re.sub(rb"next \d+", b"next -", answer)
        if FAULT == "unasked" and word == b"call":
            answer += b"up 0 op_result(success)\n"
        if FAULT == "noisy" and word == b"call":
            sys.stderr.write("noise\n" * 200_000 + "the last words\n")
            sys.stderr.flush()
        put(answer)


main()
