"""The numbers of README.md, for the tests that count them; see number.h."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]
NUMBER = r"(?<![\w,./])(\d[\d,]*)(?<!,)(?!\.\d)"


def readme():
    """The text, with single blanks between the words."""
    return " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())


def matches(words, text):
    """Returns the places of the words in the text, with a number at their '#'."""
    before, after = map(re.escape, words.split("#"))
    return list(re.finditer(before + NUMBER + after, text))


def readme_number(words):
    """The number that README.md has at the '#' of `words`: 804 for "# [vectors]"."""
    found = matches(words, readme())
    assert len(found) == 1, f"README.md does not say exactly once: {words}"
    return int(found[0][1].replace(",", ""))
