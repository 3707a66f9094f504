"""Names the functions behind libFuzzer's features, for programs whose counters are features."""

import shutil
import struct
import subprocess

PC_TABLE = "__sancov_pcs"


class Elf:
    """The sections and relative relocations of a 64-bit little-endian ELF file."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.data = file.read()
        if self.data[:6] != b"\x7fELF\x02\x01":
            raise ValueError(f"{path}: no 64-bit ELF file")
        offset, = struct.unpack_from("<Q", self.data, 0x28)
        size, count, names_at = struct.unpack_from("<HHH", self.data, 0x3A)
        # name, type, flags, address, offset, size, link, info, align, entry size
        headers = [struct.unpack_from("<IIQQQQIIQQ", self.data, offset + i * size)
                   for i in range(count)]
        strings = headers[names_at][4]
        self.sections = {}
        for header in headers:
            start = strings + header[0]
            name = self.data[start:self.data.index(b"\0", start)].decode()
            self.sections[name] = header

    def pcs(self):
        """The addresses in the table of instrumented places, in its order."""
        table = self.sections.get(PC_TABLE)
        if table is None:
            return []
        _, _, _, address, offset, size = table[:6]
        # Pairs of an address and flags. A position-independent program has its addresses as
        # addends of relocations.
        pcs = [struct.unpack_from("<Q", self.data, offset + i)[0] for i in range(0, size, 16)]
        relocations = self.sections.get(".rela.dyn")
        if relocations:
            for at in range(relocations[4], relocations[4] + relocations[5], 24):
                place, _, addend = struct.unpack_from("<QQq", self.data, at)
                if address <= place < address + size and (place - address) % 16 == 0:
                    pcs[(place - address) // 16] = addend
        return pcs


class Symbols:
    """Function names of features; none where there is no symbolizer."""

    def __init__(self, program):
        self.program = program
        self.tool = shutil.which("llvm-symbolizer-14") or shutil.which("llvm-symbolizer")
        self.pcs = Elf(program).pcs() if self.tool else []

    def names(self, places):
        """For each of these indices of the table, the functions that it lies in: the innermost
        first, then those which it is inlined in."""
        known = [self.pcs[p] for p in sorted(places) if p < len(self.pcs)]
        if not known:
            return []
        done = subprocess.run([self.tool, f"--obj={self.program}", "--functions=linkage",
                               "--demangle"], capture_output=True, text=True, check=False,
                              input="\n".join(hex(pc) for pc in known) + "\n")
        # For each address: pairs of lines, a function and its place, then an empty line.
        return [block.splitlines()[::2] for block in done.stdout.split("\n\n") if block.strip()]
