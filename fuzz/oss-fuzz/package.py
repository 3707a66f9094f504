#!/usr/bin/env python3
"""Puts the fuzz targets of a build folder into a fleet's output folder.

Usage: package.py BUILD OUT. For each target TARGET_fuzz, TARGET_fuzz.options, its dictionary as
TARGET_fuzz.dict, its seeds as TARGET_fuzz_seed_corpus.zip; in lib/ the shared libraries that a
runner may lack.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
import targets as fuzz  # pylint: disable=wrong-import-position

# Libraries of every runner: the C library, and the C++ library of its compiler.
BASE = re.compile(r"(linux-vdso|ld-linux|libc|libm|libdl|librt|libpthread|libresolv|libgcc_s"
                  r"|libstdc\+\+)[-.]")
NEEDED = re.compile(r"^\s*(\S+) => (\S.*?)(?: \(0x[0-9a-f]+\))?$", re.M)


def shared_libraries(program):
    """Names and paths of the libraries that a program loads and a runner may lack."""
    listed = subprocess.run(["ldd", program], capture_output=True, text=True, check=False).stdout
    return {name: path for name, path in NEEDED.findall(listed) if not BASE.match(name)}


def write_options(target, path, has_dictionary):
    lines = ["[libfuzzer]", f"max_len = {target.max_len}", f"timeout = {target.timeout_s}",
             f"rss_limit_mb = {fuzz.RSS_LIMIT_MB}"]
    if has_dictionary:
        lines.append(f"dict = {target.program.name}.dict")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_seeds(target, path):
    """A zip with the same bytes whenever it is built; folders become part of the names."""
    seeds = {"_".join((folder.name, *f.relative_to(folder).parts)): f.read_bytes()
             for folder in target.folders for f in sorted(folder.rglob("*")) if f.is_file()}
    if not seeds:
        raise SystemExit(f"{target.name}: no seeds")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in seeds.items():
            archive.writestr(zipfile.ZipInfo(name), content)


def main():
    build, out = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    for target in fuzz.load(build):
        name = target.program.name
        shutil.copy2(target.program, out / name)
        if target.dictionary:
            shutil.copyfile(target.dictionary, out / f"{name}.dict")
        write_options(target, out / f"{name}.options", target.dictionary is not None)
        write_seeds(target, out / f"{name}_seed_corpus.zip")
        for library, path in shared_libraries(out / name).items():
            (out / "lib").mkdir(exist_ok=True)
            if path == "not found":
                raise SystemExit(f"{name}: {library} is not found")
            if not (out / "lib" / library).exists():
                shutil.copy2(path, out / "lib" / library)


if __name__ == "__main__":
    main()
