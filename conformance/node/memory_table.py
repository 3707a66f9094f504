#!/usr/bin/env python3
"""Print what nodes of chosen sizes take on a processor, beside the paper's formula.

Usage: memory_table.py COMPILER [RADIO_OUT,RADIO_IN,SERIAL_OUT,SERIAL_IN,CHANNELS,MEMBERS ...]

COMPILER is avr-g++ or another for the processor. Without choices it shows a mote and a sink with
the sizes of the paper's Table 1. Ends with 1 if a node takes more than the formula says.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLAGS = {"avr-g++": ["-mmcu=atmega128"], "arm-none-eabi-g++": ["-mcpu=cortex-m3", "-mthumb"]}
NAMES = ("kRadioOut", "kRadioIn", "kSerialOut", "kSerialIn", "kChannels", "kMembers")
PAPER = ["4,4,2,2,4,0", "4,4,2,2,4,20"]
HEADER = '#include "conformance/node/node.h"\nusing namespace rubric::node;\n'
CHOICE = """struct Sizes{0} : MoteSizes {{
{1}}};
char node_{0}[sizeof(SizedNode<Sizes{0}>)];
char paper_{0}[paper_bytes({2}, {3})];
"""


def sizes_of(compiler, choices):
    """Returns the bytes of each choice's node and of the paper's formula."""
    code = HEADER
    for i, numbers in enumerate(choices):
        members = "".join(f"  static constexpr uint8_t {name} = {number};\n"
                          for name, number in zip(NAMES, numbers))
        code += CHOICE.format(i, members, sum(numbers[:4]), 2 * numbers[4])
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / "sizes.cc"
        source.write_text(code, encoding="utf-8")
        text = subprocess.run(
            [compiler, *FLAGS.get(pathlib.Path(compiler).name, []), "-std=c++14", "-S", "-o", "-",
             f"-I{ROOT}", source], check=True, capture_output=True, text=True).stdout
    found = {name: int(size) for name, size in
             re.findall(r"\.size\s+(node_\d+|paper_\d+), (\d+)", text)}
    return [(found[f"node_{i}"], found[f"paper_{i}"]) for i in range(len(choices))]


def main():
    compiler, *words = sys.argv[1:]
    choices = [tuple(map(int, word.split(","))) for word in words or PAPER]
    if any(len(numbers) != len(NAMES) for numbers in choices):
        print(__doc__, file=sys.stderr)
        return 2
    print("radio out/in  serial out/in  channels  members  paper  node")
    over = False
    for numbers, (node, paper) in zip(choices, sizes_of(compiler, choices)):
        print("{:>9}/{:<2}  {:>10}/{:<2}  {:>8}  {:>7}  {:>5}  {:>4}".format(*numbers, paper, node))
        over |= node > paper
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
