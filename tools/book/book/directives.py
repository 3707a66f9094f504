"""Expands directives. See tools/book/README.md."""

import base64

import diagrams
from book import appendix, chapters, markup
from book.cases import Cases
from book.html import code, escape, heading, link, table
from book.mistakes import expected
from book.rules import Rules
from book.svg import fitted
from book.wire import Wire

SHOWN_ONCE = ("layout", "enum", "mask", "rules", "case")


class Directives:
    def __init__(self, names, mistakes):
        self.names = names
        self.project = names.project
        self.mistakes = mistakes
        self.wire = Wire(names)
        self.rules = Rules(names)
        self.cases = Cases(names)
        self.shown = {kind: {} for kind in SHOWN_ONCE}  # Full name to (file, line).
        self.drawings = 0
        self.styles = {}  # Of the drawings, each once, in order.
        self.table = {
            "layout": self._one("layout", self.wire.layout),
            "mask": self._one("mask", self.wire.mask),
            "enum": self._one("enum", self.wire.enum),
            "rules": self._rules, "case": self._one("case", lambda name, _: self.cases.entry(name)),
            "dispatch": self._dispatch, "chart": self._chart, "states": self._states,
            "help": self._help, "include": self._include, "screenshot": self._screenshot,
            "coverage": lambda place, name, level: self.rules.coverage(),
            "all_layouts": self._all_layouts, "all_enums": self._all_enums,
            "all_rules": self._all_rules, "all_cases": self._all_cases,
            "profiles": lambda place, name, level: appendix.profiles(self.names, level + 1),
            "decisions": self._decisions, "external_links": lambda *_: "@EXTERNAL_LINKS@",
        }
        self.with_name = {"layout", "mask", "enum", "rules", "case", "dispatch", "chart", "states",
                          "help", "include", "screenshot"}

    def survey(self, chapter):
        """Before anything is rendered: what is shown where; the references show the rest."""
        for line, name, argument, _ in chapters.directives(chapter):
            place = (chapter.file, line)
            if name not in self.table:
                self.mistakes.add(*place, expected("directive", name, self.table))
            elif bool(argument) != (name in self.with_name):
                self.mistakes.add(*place, f"expected '{{{{{name} NAME}}}}'"
                                  if name in self.with_name else f"expected '{{{{{name}}}}}'")
            elif name == "dispatch":
                self.wire.dispatched.add(argument)
            elif name in self.shown:
                self._claim(place, name, argument)

    def _claim(self, place, kind, argument):
        known = self.names.anchors[kind]
        if kind == "rules":
            found = self.rules.select(argument)
        else:
            full = self.names.find(kind, argument)
            found = [full] if full else []
        if not found:
            what = {"layout": "message", "rules": "rule or group", "case": "golden trace"}
            names = [*known, *{one.split("-")[0] for one in known}] if kind == "rules" else known
            short = [one.removeprefix("rubicon::") for one in names]
            self.mistakes.add(*place, expected(what.get(kind, kind), argument, short))
        for one in found:
            if one in self.shown[kind]:
                file, line = self.shown[kind][one]
                self.mistakes.add(*place, f"{one} is shown at {file}:{line} already; "
                                  "expected a link to it here")
            else:
                self.shown[kind][one] = place

    def expand(self, chapter, line, name, argument, level):
        """HTML; empty where the survey has found a mistake."""
        place = (chapter.file, line)
        if name not in self.table or bool(argument) != (name in self.with_name):
            return ""
        return self.table[name](place, argument, level)

    def _one(self, kind, make):
        def show(place, argument, level):
            full = self.names.find(kind, argument)
            return make(full, level + 1) if full and self.shown[kind][full] == place else ""
        return show

    def _rules(self, place, argument, level):
        return "\n".join(self.rules.entry(rule, level + 1) for rule in self.rules.select(argument)
                         if self.shown["rules"][rule] == place)

    def _left(self, kind):
        return [one for one in self.names.anchors[kind] if one not in self.shown[kind]]

    def _index(self, kinds, caption):
        rows = []
        for kind in kinds:
            for full, anchor in self.names.anchors[kind].items():
                spec, short = full.split("::")
                one = self.project.types.get(full, {})
                numbers = ", ".join(map(str, one.get("am_types", [])))
                rows.append([link(anchor, code(short)), spec, numbers,
                             self.names.rich(one.get("doc", ""))])
        return table(["name", "spec", "AM type", "what"], rows, caption, "index")

    @staticmethod
    def _rest(level, anchor, title, entries):
        """Returns the full text of a reference."""
        return "\n".join([heading(level, anchor, title), *entries]) if entries else ""

    def _all_layouts(self, _place, _name, level):
        left = [self.wire.layout(one, level + 2) for one in self._left("layout")]
        return self._index(["layout"], "All messages and their parts") + self._rest(
            level + 1, "messages-shown-here", "Messages that no chapter shows", left)

    def _all_enums(self, _place, _name, level):
        rows = []
        for kind in ("enum", "mask"):
            for full, anchor in self.names.anchors[kind].items():
                spec, short = full.split("::")
                one = self.project.enums.get(full) or self.project.types[full]
                count = len(one.get("entries", one.get("bits", [])))
                rows.append([link(anchor, code(short)), kind, spec,
                             f"{count} {'values' if kind == 'enum' else 'bits'}"])
        out = [table(["name", "kind", "spec", "size"], rows, "All enums and masks", "index")]
        out += [self.wire.enum(one, level + 1) for one in self._left("enum")]
        out += [self.wire.mask(one, level + 1) for one in self._left("mask")]
        return "\n".join(out)

    def _all_rules(self, _place, _name, level):
        left = [self.rules.entry(one, level + 2) for one in self._left("rules")]
        return self.rules.index() + self._rest(
            level + 1, "rules-shown-here", "Rules that no chapter shows", left)

    def _all_cases(self, _place, _name, level):
        return self.cases.all(self._left("case"), level + 1)

    def _decisions(self, _place, _name, level):
        def convert(text, file):
            text = appendix.without_files(text, file, self.project)
            chapter = chapters.Chapter(file, "", "", "", list(markup.split(text.splitlines())))
            chapters.render(chapter, lambda *_: "", self.names)
            return chapter.html
        return appendix.decisions(self.names, level + 1, convert)

    def _dispatch(self, place, name, _level):
        carriers = [one["carrier"] for one in self.project.types.values() if "carrier" in one]
        if name in carriers:
            return self.wire.dispatch(name)
        self.mistakes.add(*place, expected("carrier", name, carriers))
        return ""

    def _draw(self, place, draw, name):
        """A drawing of diagrams.py, in which rules lead to themselves."""
        try:
            svg = draw(self.project.rubric, name, lambda rule: f"#{rule}")
            self.drawings += 1
            svg, style = fitted(svg, f"d{self.drawings}-")
            self.styles[style] = None
            return svg
        except (OSError, RuntimeError, ValueError) as error:
            self.mistakes.add(*place, f"{name}: {str(error).splitlines()[0]}")
            return ""

    def _chart(self, place, name, _level):
        if name not in self.project.cases:
            self.mistakes.add(*place, expected("golden trace", name, self.project.cases))
            return ""
        svg = self._draw(place, diagrams.chart_svg, name)
        caption = self.names.rich(self.project.cases[name].get("comment", ""))
        return (f'<figure class="drawing chart"><div class="scroll">{svg}</div>'
                f"<figcaption>{link(name, code(name))} {caption}</figcaption></figure>") \
            if svg else ""

    def _states(self, place, name, _level):
        known = diagrams.STATES
        if name not in known:
            self.mistakes.add(*place, expected("state diagram", name, known))
            return ""
        svg = self._draw(place, diagrams.states_svg, name)
        what = ("each question that the reference machine's answers depend on"
                if name.endswith("_reception") else
                "every transition that the reference machine makes in small networks")
        return (f'<figure class="drawing states"><div class="scroll">{svg}</div>'
                f"<figcaption>{escape(known[name])}: {what}."
                "</figcaption></figure>") if svg else ""

    def _help(self, place, name, _level):
        try:
            text = self.project.run(*name.split(), "--help")
        except RuntimeError:
            commands = self.project.commands()
            self.mistakes.add(*place, expected("command of rubric", name, commands))
            return ""
        return (f'<figure class="listing help"><figcaption>{code(f"rubric {name} --help")}'
                f'</figcaption><pre class="code"><code>{escape(text.strip())}</code></pre>'
                "</figure>")

    def _screenshot(self, place, name, _level):
        """A PNG file of tools/book/screenshots, and the text for who does not see it."""
        name, _, text = name.partition(" ")
        path = self.project.root / "tools/book/screenshots" / name
        if not text or not path.is_file():
            self.mistakes.add(*place, "expected a file of tools/book/screenshots and what it shows")
            return ""
        data = base64.b64encode(path.read_bytes()).decode()
        return (f'<figure class="screenshot"><img src="data:image/png;base64,{data}" '
                f'alt="{escape(text)}"></figure>')

    def _include(self, place, name, _level):
        path = (self.project.root / name).resolve()
        if not path.is_relative_to(self.project.root.resolve()) or not path.is_file():
            self.mistakes.add(*place, f"no file of the project is called '{name}'; expected a path "
                              "from the project's folder")
            return ""
        text = escape(path.read_text(encoding="utf-8").strip())
        return (f'<figure class="listing"><figcaption>{code(name)}</figcaption>'
                f'<pre class="code"><code>{text}</code></pre></figure>')
