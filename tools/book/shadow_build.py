#!/usr/bin/env python3
"""Builds in a copy of the project what a new or changed wire spec changes, in seconds in place of
minutes: the generated files, the three parts of rubric that hold its tables, and rubric of these
and of the libraries that are already built.

Usage: shadow_build.py BUILD_FOLDER COPY TARGET. TARGET is regenerate or rubric.
"""

import pathlib
import shlex
import subprocess
import sys

EMITTERS = "cpp,tables,requirements,protocols,dictionary,messages,profiles,cases,java,lua"
# Sources with the tables of all protocols, the routes to their messages, and all rule texts.
HOLDERS = ("codec/reflect/registry.cc", "codec/frame_generator/routes.cc",
           "codec/reflect/requirements.cc")


def run(words, folder):
    done = subprocess.run(words, cwd=folder, check=False)
    if done.returncode:
        sys.exit(done.returncode)


def regenerate(copy):
    specs = sorted(str(path.relative_to(copy)) for path in (copy / "spec/wire").glob("*.ksy"))
    run(["rubricc", "--emit", EMITTERS, "--out", ".", *specs], copy)


def holds_tables(source, root):
    """Of a source, and of a unit (.cxx) that CMake makes of several, with an #include of each."""
    holders = {str(root / holder) for holder in HOLDERS}
    if source.suffix == ".cc":
        return str(source) in holders
    return not holders.isdisjoint(source.read_text(encoding="utf-8").split('"'))


def rebuild(build, root, copy):
    listed = subprocess.run(["ninja", "-C", build, "-t", "commands", "rubric"], check=True,
                            capture_output=True, text=True).stdout
    known = [shlex.split(line.removeprefix(": && ").removesuffix(" && :"))
             for line in listed.splitlines()]
    objects = []
    for words in known:
        source = pathlib.Path(words[-1])
        if source.suffix not in {".cc", ".cxx"} or not holds_tables(source, root):
            continue
        ours = copy / "build" / f"holder_{len(objects)}.cc"
        text = f'#include "{source}"\n' if source.suffix == ".cc" else source.read_text("utf-8")
        ours.write_text(text.replace(f'"{root}/', f'"{copy}/'), encoding="utf-8")
        objects.append(f"{ours}.o")
        at = words.index("-o")
        words[at:at + 2] = ["-O0", "-o", objects[-1]]  # It runs a few times.
        words[words.index("-MF") + 1] = f"{ours}.d"
        words[-1] = str(ours)
        words = [word for word in words if word != "-Winvalid-pch"]  # Precompiled for others.
        run([f"-I{copy}" if word == f"-I{root}" else word for word in words], build)
    program = copy / ".bin/rubric"
    program.unlink()
    link = known[-1]
    at = link.index("-o")
    link[at:at + 2] = [*objects, "-o", str(program)]
    run(link, build)


def main():
    build, copy = (pathlib.Path(word) for word in sys.argv[1:3])
    root = pathlib.Path(__file__).resolve().parents[2]
    if sys.argv[3] == "regenerate":
        regenerate(copy)
    elif sys.argv[3] == "rubric":
        rebuild(build, root, copy)
    else:
        sys.exit(f"shadow_build.py knows no target {sys.argv[3]}")


if __name__ == "__main__":
    main()
