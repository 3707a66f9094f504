"""Every link of the book leads somewhere, every anchor exists once, every tag is closed."""

import re
from html.parser import HTMLParser
from urllib.parse import urlsplit

from book import chapters
from book.html import slug

_ALONE = {"meta", "link", "br", "hr", "input", "img", "wbr", "col"}


class Outline(HTMLParser):
    """Collects the anchors and links of a piece of HTML, and faults of its tags."""

    def __init__(self, text):
        super().__init__()
        self.anchors = []
        self.links = []
        self.wrong = []
        self._open = []
        self.feed(text)
        self.close()
        self.wrong += [f"<{tag}> is never closed" for tag in self._open]

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name == "id":
                self.anchors.append(value)
            elif name == "href":
                self.links.append(value)
            elif name == "src" and value.startswith("data:image/png;base64,"):
                continue
            elif name in {"style", "src", "srcset", "action"} or name.startswith("on"):
                self.wrong.append(f"the page allows no attribute '{name}'")
        if tag not in _ALONE:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in _ALONE:
            self._open.pop()

    def handle_endtag(self, tag):
        if tag in _ALONE:
            return
        if not self._open or self._open.pop() != tag:
            self.wrong.append(f"</{tag}> closes what is not open")


def is_external(target):
    return not target.startswith("#")


def external_fault(target):
    """Returns what is wrong with a link that leads out of the book; none if nothing is."""
    parts = urlsplit(target)
    if parts.scheme not in {"https", "http"}:
        return f"'{target}' leads to a file that the reader may not have; expected https://..."
    if not re.fullmatch(r"[\w-]+(\.[\w-]+)+(:\d+)?", parts.netloc) or re.search(r"\s", target):
        return f"'{target}' is not an address; expected https://HOST/PATH"
    return None


def _line_of(chapter, needle):
    """The line of a chapter that has the text; 0 if none has."""
    return next((number for number, kind, value in chapter.pieces
                 if kind == "text" and needle in value), 0)


def _heading_line(chapter, anchor):
    """The line of a heading with this anchor, said or made of its text."""
    for number, kind, value in chapter.pieces:
        if kind == "text" and value.startswith("#") and (
                "{#" + anchor + "}" in value or slug(value.lstrip("#")) == anchor):
            return number
    # An anchor that a directive gives.
    return next((number for number, name, argument, _ in chapters.directives(chapter)
                 if anchor.startswith(argument or name)), 0)


def check(all_chapters, page_anchors, mistakes):
    """Adds what is wrong; returns the links that lead out, each once, in order of the text."""
    outlines = [(one, Outline(one.html)) for one in all_chapters]
    owner = {anchor: None for anchor in page_anchors}
    for chapter, outline in outlines:
        for wrong in outline.wrong:
            mistakes.add(chapter.file, 0, wrong)
        for anchor in outline.anchors:
            if anchor in owner:
                where = owner[anchor] or "the page"
                line = _heading_line(chapter, anchor)
                mistakes.add(chapter.file, line, f"#{anchor} exists already, in {where}; expected "
                             "another heading or one with {#name}")
            owner.setdefault(anchor, chapter.file)
    external = {}
    for chapter, outline in outlines:
        for target in outline.links:
            if is_external(target):
                external[target] = None
                fault = external_fault(target)
            else:
                fault = None if target[1:] in owner else \
                    f"{target} leads nowhere; no heading, rule, message or case has it"
            if fault:
                mistakes.add(chapter.file, _line_of(chapter, target), fault)
    return list(external)
