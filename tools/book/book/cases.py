"""The golden traces."""

import re

from book.html import code, escape, heading, mark

_CASE = re.compile(r"case (\S+)")


class Cases:
    def __init__(self, names):
        self.names = names
        self.project = names.project
        self._texts = {}
        for file in sorted({one["file"] for one in self.project.cases.values()}):
            self._read(file)

    def _read(self, file):
        """Splits a file at its cases; lines before the first belong to all of them."""
        head, name, out = [], None, []
        for line in self.project.read(file).splitlines():
            found = _CASE.match(line)
            if found:
                name, out = found[1], []
                self._texts[name] = (head, out)
            (head if name is None else out).append(line)

    def text(self, name):
        head, lines = self._texts[name]
        shown = [line for line in head if line.startswith("%")]
        return "\n".join(shown + [""] + lines).strip()

    def entry(self, name):
        one = self.project.cases[name]
        rules = ", ".join(map(self.names.rule_link, one["rules"]))
        comment = escape(one.get("comment", ""))  # No links: it is what unfolds the case.
        return (f'<details class="case" id="{escape(name)}" data-find="{escape(name)} case">'
                f"<summary>{code(name)} <span>{escape(', '.join(one['roles']))}</span>"
                f'<span class="why">{comment}</span></summary>'
                f'<dl class="facts"><dt>Rules</dt><dd>{rules}</dd><dt>File</dt>'
                f"<dd>{code(one['file'])}{mark(name)}</dd></dl>"
                f'<pre class="code"><code>{escape(self.text(name))}</code></pre></details>')

    def all(self, names, level):
        """By file, each with a heading."""
        files = {}
        for name in names:
            files.setdefault(self.project.cases[name]["file"], []).append(name)
        out = []
        for file, ones in files.items():
            short = file.removeprefix("conformance/cases/").removesuffix(".rtr")
            out.append(heading(level, "cases-" + short.replace("/", "-"), code(short), "entry"))
            out += [self.entry(one) for one in ones]
        return "\n".join(out)
