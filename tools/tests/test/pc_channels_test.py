#!/usr/bin/env python3
"""Base stations of the kit refuse the calls of synaptic channels alike (decision 135).

Usage: pc_channels_test.py RUBRIC TARGET...
"""

import sys
import unittest

from testing import Folder, rubric

CALLS = {"create_out(dest=11:5 size=1 mode=reliable)": "channel_result(0->0 fail)",
         "create_in(src=11:5 size=1 mode=power_save)": "channel_result(0->0 fail)",
         "read_input(null->5 pos=0)": "input_value(0 fail)", "start(null->5)": "op_result(fail)",
         "stop(null->5)": "op_result(fail)", "dispose(null->5)": "op_result(fail)",
         "write_output(null->5 pos=0 value=1)": "op_result(fail)",
         "set_time_step(512)": "op_result(fail)", "start_all": "op_result(fail)",
         "stop_all": "op_result(fail)"}


class Channels(Folder):
    def test_calls_are_refused(self):
        lines = ["%rtr 1", "%profile paper"]
        for i, (call, answer) in enumerate(CALLS.items()):
            lines += [f"case pc.call{i}", "; A call of channels.",
                      "%node bA base_station island=11 iut", f"a: 100     bA < app {call}",
                      f"   a+0..50 bA > app {answer}"]
        trace = self.write("pc.rtr", "\n".join(lines) + "\n")
        for target in TARGETS:
            with self.subTest(target=target):
                _, out, err = rubric("test", "--target", target, trace)
                self.assertIn(f": {len(CALLS)} pass.", out, err)


if __name__ == "__main__":
    TARGETS = sys.argv[1:]
    del sys.argv[1:]
    unittest.main()
