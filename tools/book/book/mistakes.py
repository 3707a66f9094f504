"""Mistakes in the text of the book: all of a run are collected, then shown together."""

import difflib


class Mistakes:
    def __init__(self):
        self._found = []

    def add(self, file, line, text):
        """`line` counts from 1; 0 means the file as a whole."""
        self._found.append((str(file), line, text))

    def lines(self):
        """FILE:LINE: text, in order of place, each once."""
        places = sorted(set(self._found))
        return [f"{file}:{line}: {text}" if line else f"{file}: {text}"
                for file, line, text in places]

    def __bool__(self):
        return bool(self._found)


def expected(what, name, names):
    """The text for a name that does not exist: expected are names that are like it, else any."""
    names = sorted(set(names))
    shown = difflib.get_close_matches(name, names, 3, 0.7) or names
    more = f" and {len(shown) - 12} more" if len(shown) > 12 else ""
    return f"no {what} is called '{name}'; expected {', '.join(shown[:12])}{more}"
