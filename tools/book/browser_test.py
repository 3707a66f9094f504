#!/usr/bin/env python3
"""Makes the book and looks at it in a browser; see browser_test.js.

Usage: browser_test.py RUBRIC RUBRICC [SHOTS_FOLDER]
"""

import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def main():
    rubric, rubricc, *shots = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        book = str(pathlib.Path(folder) / "rubric.html")
        subprocess.run([sys.executable, HERE / "make_book.py", "--rubric", rubric,
                        "--rubricc", rubricc, "--out", book], check=True)
        return subprocess.run(["node", HERE / "browser_test.js", book, *shots],
                              check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
