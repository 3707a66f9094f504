#!/usr/bin/env python3
"""All C++ sources are in the project's own clang-format.

Usage: clang_format_test.py CLANG_FORMAT. Renew with: clang-format-14 -i FILE...
"""

import subprocess
import sys


def main():
    tracked = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.cc", "*.h", "*.c"],
                             check=True, capture_output=True, text=True).stdout.split()
    sources = [path for path in tracked if "generated" not in path.split("/")]
    if not sources:
        raise SystemExit("no sources")
    result = subprocess.run([sys.argv[1], "--dry-run", "-Werror", *sources], check=False)
    print(f"{len(sources)} files")
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
