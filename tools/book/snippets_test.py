#!/usr/bin/env python3
"""The chapters of the book show what happens; snippets.py explains which texts are run and how.

Usage: snippets_test.py BUILD_FOLDER [--write] [--codec-only] [CHAPTER.md...]
--write puts what is printed into the chapters. --codec-only lays down the codec's headers alone in
place of an installation, for a build folder in which only rubric and rubricc are built.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

import snippets

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODEC_ONLY = """add_library(rubric::codec INTERFACE IMPORTED)
target_include_directories(rubric::codec INTERFACE
  ${CMAKE_CURRENT_LIST_DIR}/../../../include/rubric)
"""
CODEC_ONLY_PC = "Name: rubric-codec\nDescription: headers\nVersion: 0\nCflags: -I{}\n"


def install(build, prefix):
    done = subprocess.run(["cmake", "--install", build, "--prefix", prefix], capture_output=True,
                          text=True, check=False)
    if done.returncode:
        sys.exit(f"cannot install from {build}:\n{done.stderr}")


def lay_down_codec(prefix):
    shutil.copytree(ROOT / "codec", prefix / "include/rubric/codec")
    package = prefix / "lib/cmake/rubric"
    package.mkdir(parents=True)
    (package / "rubric-config.cmake").write_text(CODEC_ONLY, encoding="utf-8")
    found = prefix / "lib/pkgconfig"
    found.mkdir()
    (found / "rubric-codec.pc").write_text(CODEC_ONLY_PC.format(prefix / "include/rubric"),
                                           encoding="utf-8")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--codec-only", action="store_true")
    parser.add_argument("chapters", nargs="*", type=pathlib.Path)
    options = parser.parse_intermixed_args()
    build = options.build.resolve()
    chapters = options.chapters or sorted((ROOT / "tools/book/chapters").glob("*.md"))
    failed = worked = 0
    with tempfile.TemporaryDirectory(prefix="rubric-book-") as scratch:
        prefix = pathlib.Path(scratch) / "prefix"
        if options.codec_only:
            lay_down_codec(prefix)
        else:
            install(build, prefix)
        for chapter in chapters:
            text = chapter.read_text(encoding="utf-8")
            if not snippets.blocks(text):
                continue
            place = snippets.Place(pathlib.Path(scratch) / chapter.stem, ROOT, build, prefix)
            now, wrong = snippets.renewed(text, place)
            worked += len(snippets.blocks(text))
            if options.write and now != text:
                chapter.write_text(now, encoding="utf-8")
                print(f"{chapter.name}: renewed")
                wrong = [mistake for mistake in wrong if "it should show" not in mistake[1]]
            for line, what in wrong:
                print(f"{chapter.name}:{line}: {what}")
            failed += len(wrong)
    print(f"{worked} blocks of {len(chapters)} chapters, {failed} wrong")
    if failed:
        print(f"Renew what is printed with: python3 tools/book/snippets_test.py {options.build} "
              "--write")
    return 1 if failed or not worked else 0


if __name__ == "__main__":
    sys.exit(main())
