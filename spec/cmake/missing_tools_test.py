#!/usr/bin/env python3
"""A test that a missing tool switches off is an error with RUBRIC_ALL_TOOLS, and a warning without.

Usage: missing_tools_test.py PROJECT_FOLDER. Configures the project with every tool hidden that a
CMakeLists.txt looks for: each must be named.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

# Tests run the first by name as well, so that they fail without it; the program needs the second.
ALWAYS_NEEDED = {"RUBRIC_BOOK_PYTHON", "RUBRIC_ZSTD_LIBRARY"}


def main():
    root = pathlib.Path(sys.argv[1])
    files = subprocess.run(["git", "ls-files", "*CMakeLists.txt"], cwd=root, check=True,
                           capture_output=True, text=True).stdout.split()
    text = "".join((root / file).read_text(encoding="utf-8") for file in files)
    tools = set(re.findall(r"find_(?:program|library)\(\s*(\S+)", text)) - ALWAYS_NEEDED
    wrong = [] if tools else ["no CMakeLists.txt looks for a tool"]
    with tempfile.TemporaryDirectory() as build:
        for all_tools in ("ON", "OFF"):
            done = subprocess.run(
                ["cmake", "-S", root, "-B", build, "-G", "Ninja", "-DRUBRIC_TESTS=ON",
                 f"-DRUBRIC_ALL_TOOLS={all_tools}", *(f"-D{tool}=OFF" for tool in tools)],
                capture_output=True, text=True, check=False)
            if (done.returncode != 0) != (all_tools == "ON"):
                wrong.append(f"RUBRIC_ALL_TOOLS={all_tools}: exit {done.returncode}\n{done.stderr}")
            wrong += [f"RUBRIC_ALL_TOOLS={all_tools}: nobody says that {tool} is missing"
                      for tool in sorted(tools) if tool not in done.stderr]
    print("\n".join(wrong) or f"each of {len(tools)} tools is missed")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
