#!/usr/bin/env python3
"""Every number of README.md's chapter Trust is asserted by the test that counts it.

Tests ask for their numbers by `readme_number("words with a # in place of it")`. This one
searches all sources for such words: README.md has each exactly once, and no number that no test
asks for.
"""

import pathlib
import re
import subprocess
import sys

from number import NUMBER, ROOT, matches, readme

ASKED = re.compile(r"""readme_?[nN]umber\(\s*(["'])(.*?)\1\)""")
SOURCES = ["*.cc", "*.py", "*.js"]


def asked():
    """The words by which tests ask, with their file."""
    files = subprocess.run(["git", "grep", "-lE", "readme_?[nN]umber", "--", *SOURCES], cwd=ROOT,
                           check=True, capture_output=True, text=True).stdout.split()
    for file in files:
        if pathlib.Path(file).name != pathlib.Path(__file__).name:
            for _, words in ASKED.findall((ROOT / file).read_text(encoding="utf-8")):
                yield file, words


def mistakes(text, questions):
    trust = text.index("## Trust")
    end = text.index("`tools/bench`", trust)
    unasked = {trust + found.start(1) for found in re.finditer(NUMBER, text[trust:end])}
    for file, words in questions:
        found = matches(words, text)
        if len(found) != 1:
            yield f"{file}: README.md says {len(found)} times, not once: {words}"
        unasked -= {match.start(1) for match in found}
    for at in sorted(unasked):
        yield f"README.md: no test asserts the number in: {text[at - 30:at + 30]}"


def main():
    text = readme()
    questions = list(asked())
    found = list(mistakes(text, questions))
    # A number that no test knows is found, and words that README.md does not have.
    planted = text.replace("## Trust", "## Trust 12,345 frames")
    assert len(list(mistakes(planted, questions))) == len(found) + 1
    assert len(list(mistakes(text, [*questions, ("", "# unicorns")]))) == len(found) + 1
    for mistake in found:
        print(mistake)
    print(f"{len(questions)} numbers are asserted, {len(found)} mistakes")
    return 1 if found or not questions else 0


if __name__ == "__main__":
    sys.exit(main())
