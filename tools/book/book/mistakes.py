"""Mistakes in the text of the book: all of a run are collected, then shown together."""


class Mistakes:
    def __init__(self):
        self._found = []

    def add(self, file, line, text):
        """`line` counts from 1; 0 stands for the file as a whole."""
        self._found.append((str(file), line, text))

    def lines(self):
        """FILE:LINE: text, in order of place, each once."""
        places = sorted(set(self._found))
        return [f"{file}:{line}: {text}" if line else f"{file}: {text}"
                for file, line, text in places]

    def __bool__(self):
        return bool(self._found)


def expected(what, name, names):
    """The text for a name that does not exist: names that are like it, else all of them."""
    alike = [one for one in names if name.lower() in one.lower() or one.lower() in name.lower()]
    shown = sorted(alike or names)
    more = f" and {len(shown) - 12} more" if len(shown) > 12 else ""
    return f"no {what} is called '{name}'; there is {', '.join(shown[:12])}{more}"
