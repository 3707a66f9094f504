"""Chapters: their files, and from those to HTML."""

import dataclasses
import re

from book import markup, texts
from book.html import slug

_PART = re.compile(r"<!-- part: (.+) -->")
_TITLE = re.compile(r"# +(.+?)(?:\s*\{#([\w.-]+)\})?\s*$")
_HEADING = re.compile(r"(#{1,6}) ")
_CODE = re.compile(r"(`+).*?\1")
_TAG = re.compile(r"</?[A-Za-z][^>]*>|<!--")


@dataclasses.dataclass
class Chapter:
    file: str  # From the project's folder.
    part: str
    title: str
    anchor: str
    pieces: list  # Of markup.split().
    html: str = ""
    headings: list = dataclasses.field(default_factory=list)


def read(folder, root, mistakes):
    """The chapters in the order of their numbers."""
    out = []
    part = ""
    for path in sorted(folder.glob("[0-9][0-9]-*.md")):
        file = str(path.relative_to(root)) if path.is_relative_to(root) else path.name
        pieces = list(markup.split(texts.lines_of(path, root, mistakes)))
        found = _PART.fullmatch(pieces[0][2].strip()) if pieces and pieces[0][1] == "text" else None
        if found:
            part = found[1]
            pieces = pieces[1:]
        pieces = [piece for i, piece in enumerate(pieces)
                  if piece[1] != "text" or piece[2].strip() or i]
        title = _TITLE.match(pieces[0][2]) if pieces and pieces[0][1] == "text" else None
        if not title:
            mistakes.add(file, 1, "expected '# Title' at the beginning of the chapter")
            continue
        out.append(Chapter(file, part, title[1], title[2] or slug(title[1]), pieces))
        _check(out[-1], mistakes)
    if not out:
        mistakes.add(folder, 0, "expected chapters called NN-name.md")
    return out


def _check(chapter, mistakes):
    titles = 0
    level = 1
    for number, kind, value in chapter.pieces:
        if kind == "fence" and value is None:
            mistakes.add(chapter.file, number, "expected a line that closes this fence")
        if kind != "text":
            continue
        bare = _CODE.sub("", value)
        if "{{" in bare:
            mistakes.add(chapter.file, number, "expected a directive alone on its line")
        if _TAG.search(re.sub(r"<https?://[^>]*>", "", bare)):
            mistakes.add(chapter.file, number, "expected no HTML; put '<' in text into `code`")
        found = _HEADING.match(value)
        if not found:
            continue
        titles += found[1] == "#"
        if len(found[1]) > level + 1:
            mistakes.add(chapter.file, number,
                         f"expected a heading of level {level + 1} at most below one of {level}")
        level = len(found[1])
        if found[1] == "#" and titles > 1:
            mistakes.add(chapter.file, number, "expected one heading of level 1")


def directives(chapter):
    """(line, name, argument, level of the heading above) of each."""
    level = 1
    for number, kind, value in chapter.pieces:
        found = _HEADING.match(value) if kind == "text" else None
        if found:
            level = len(found[1])
        if kind == "directive":
            name, _, argument = value.strip()[2:-2].strip().partition(" ")
            yield number, name, argument.strip(), level


def render(chapter, expand, names):
    """Fills html and headings; `expand` gives the HTML of a directive: (line, name, argument,
    level) in, text out."""
    blocks = []
    lines = []

    def place(block, indent=""):
        lines.extend(["", indent + markup.PLACE.format(len(blocks)), ""])
        blocks.append(block)

    waiting = directives(chapter)
    for _, kind, value in chapter.pieces:
        if kind == "text":
            lines.append(value)
        elif kind == "directive":
            place(expand(chapter, *next(waiting)))
        elif value is not None:
            indent, language, words, body = value
            place(markup.code_block(language, words, body), indent)
    chapter.html, chapter.headings = markup.convert("\n".join(lines), names, blocks)
