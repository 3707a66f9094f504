#!/usr/bin/env python3
"""Prints the flash and RAM of each firmware and holds them to what its processor has.

Usage: memory_test.py SIZE_TOOL NM_TOOL FLASH_MAX RAM_MAX ELF... RAM_MAX leaves room for the stack.
"""

import re
import subprocess
import sys

FORBIDDEN = re.compile(r"malloc|calloc|^free$|^_Zn[wa]|^_Zd[la]|__cxa_throw|__cxa_allocate|printf")


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main():
    size_tool, nm_tool, flash_max, ram_max, *elf_files = sys.argv[1:]
    failed = not elf_files
    for elf_file in elf_files:
        text, data, bss = map(int, output_of(size_tool, elf_file).splitlines()[1].split()[:3])
        print(f"{elf_file.rsplit('/', 1)[-1]}: {text + data} bytes of flash, {data + bss} of RAM")
        if not 4000 < text + data <= int(flash_max) or not 1000 < data + bss <= int(ram_max):
            print(f"  at most {flash_max} of flash and {ram_max} of RAM")
            failed = True
        symbols = [line.split()[-1] for line in output_of(nm_tool, elf_file).splitlines()]
        heap = [symbol for symbol in symbols if FORBIDDEN.search(symbol)]
        if heap or len(symbols) < 20:
            print(f"  firmware has neither heap, exceptions nor streams: {' '.join(heap)}")
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
