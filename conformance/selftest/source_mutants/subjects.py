"""The implementations whose sources are mutated."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Subject:
    folder: str
    files: tuple            # Patterns below the folder.
    left_out: tuple = ()    # Names of files that no trace can see.
    as_it_is: tuple = ()    # Names of files that are copied without mutants.
    language: str = "c++"
    scope: str = ""         # The namespace.
    flags: tuple = ()       # Of the compiler.
    unit: str = ""          # The header that includes all others, where there are no sources.

    def paths(self, project):
        found = {path for pattern in self.files for path in (project / self.folder).glob(pattern)}
        return sorted(str(path.relative_to(project)) for path in found
                      if path.name not in self.left_out)


SUBJECTS = {
    # hash.cc tells the explorer's states apart; ticks.h converts times for captures; what event.h
    # calls a result is for the fuzz targets' watch and `rubric run`.
    "machine": Subject("conformance/machine", ("*.cc", "*.h"),
                       ("hash.cc", "ticks.h", "event.h", "machine_bench.cc"),
                       scope="rubric::machine"),
    # serial_port.h is the serial stack of boards, below what rct/1 sees; refusal.h is for `rubric
    # run`; the others are sizes.
    "cpp": Subject("conformance/node", ("*.h",),
                   ("serial_port.h", "refusal.h", "memory.h", "sizes.h"),
                   unit="silence.h",
                   scope="rubric::node"),
    "python": Subject("conformance/adapters/python", ("*.py",), as_it_is=("adapter.py", "words.py"),
                      language="python"),
}
