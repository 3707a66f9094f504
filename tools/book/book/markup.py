"""Markdown as chapters have it. Directives and fenced code are taken out before, by line, so that
each mistake has its place; the rest is python3-markdown's."""

import re
import xml.etree.ElementTree as ElementTree

import markdown
from markdown.extensions import Extension
from markdown.inlinepatterns import InlineProcessor
from markdown.treeprocessors import Treeprocessor

from book.html import code, escape, slug
from book.names import DECISION, RULE

_FENCE = re.compile(r"(\s*)(`{3,})\s*(\w*)\s*(.*?)\s*$")
_HEADINGS = {"h1", "h2", "h3", "h4", "h5", "h6"}
PLACE = "block-{}-of-this-chapter"  # Stands for a block while Markdown works.


def code_block(language, words, lines):
    """Fenced code. A console's prompts are not selected, so that commands can be copied."""
    named = dict(word.split("=", 1) for word in words.split() if "=" in word)
    shown = []
    for line in lines:
        if language == "console" and line.startswith("$ "):
            shown.append('<span class="prompt">$ </span>'
                         f'<span class="command">{escape(line[2:])}</span>')
        elif language == "diff" and re.match(r"(\+(?!\+\+ )|-(?!-- ))", line):
            css = "added" if line[0] == "+" else "removed"
            shown.append(f'<span class="{css}">{escape(line)}</span>')
        else:
            shown.append(escape(line))
    caption = f'<figcaption>{code(named["file"])}</figcaption>' if "file" in named else ""
    text = "\n".join(shown)
    return (f'<figure class="listing {escape(language)}">{caption}<pre class="code"><code>{text}'
            "</code></pre></figure>")


class _Tree(Treeprocessor):
    """Anchors of headings, links of inline code, notes."""

    def __init__(self, md, names, headings):
        super().__init__(md)
        self.names = names
        self.headings = headings

    def run(self, root):
        for parent in list(root.iter()):
            for i, child in enumerate(list(parent)):
                if child.tag == "code" and parent.tag not in {"a", "pre"}:
                    self._link(parent, i, child)
        for one in root.iter():
            if one.tag in _HEADINGS:
                self._heading(one)
            elif one.tag == "p" and len(one) and one[0].tag == "strong" \
                    and one[0].text == "Note:" and not (one.text or "").strip():
                one.set("class", "note")

    def _link(self, parent, i, child):
        text = "".join(child.itertext())
        anchor = self.names.anchor_of_code(getattr(text, "strip", str)())
        if anchor is None:
            return
        wrapped = ElementTree.Element("a", {"href": "#" + anchor})
        wrapped.tail, child.tail = child.tail, None
        wrapped.append(child)
        parent[i] = wrapped

    def _heading(self, one):
        text = "".join(one.itertext())
        anchor = one.get("id") or slug(text)
        one.set("id", anchor)
        self.headings.append((int(one.tag[1]), anchor, text))


class _Mention(InlineProcessor):
    """A link to what the text names; `anchor_of` takes the match, and gives None for no link."""
    ANCESTOR_EXCLUDES = ("a",)

    def __init__(self, pattern, anchor_of):
        super().__init__(pattern)
        self.anchor_of = anchor_of

    def handleMatch(self, m, data):  # pylint: disable=invalid-name,arguments-renamed
        anchor = self.anchor_of(m)
        if anchor is None:
            return None, None, None
        element = ElementTree.Element("a", {"href": "#" + anchor})
        element.text = m[0]
        return element, m.start(0), m.end(0)


class _Book(Extension):
    def __init__(self, names, headings):
        super().__init__()
        self.names = names
        self.headings = headings

    def extendMarkdown(self, md):  # pylint: disable=invalid-name
        md.preprocessors.deregister("html_block")
        md.inlinePatterns.deregister("html")
        decision = _Mention(DECISION, self.names.anchor_of_decision)
        md.inlinePatterns.register(decision, "decision", 60)
        md.inlinePatterns.register(_Mention(RULE, self.names.anchor_of_rule), "rule", 59)
        md.treeprocessors.register(_Tree(md, self.names, self.headings), "book", 5)


def split(lines):
    """(number, 'text' or 'directive' or 'fence', value) of the lines of a chapter; of a fence the
    value is (indent, language, words, lines), or None where it is never closed."""
    i = 0
    while i < len(lines):
        fence = _FENCE.match(lines[i])
        number = i + 1
        i += 1
        if not fence:
            bare = lines[number - 1].strip()
            is_directive = bare.startswith("{{") and bare.endswith("}}")
            yield number, "directive" if is_directive else "text", lines[number - 1]
            continue
        indent, ticks = fence[1], fence[2]
        body = []
        while i < len(lines) and lines[i].strip() != ticks:
            body.append(lines[i].removeprefix(indent))
            i += 1
        closed = i < len(lines)
        i += 1
        yield number, "fence", (indent, fence[3], fence[4], body) if closed else None


def convert(text, names, blocks):
    """(HTML, headings); `blocks` are put where their PLACE is."""
    headings = []
    md = markdown.Markdown(
        extensions=["tables", "def_list", "attr_list", "sane_lists", _Book(names, headings)],
        output_format="html")
    html = md.convert(text)
    html = re.sub(r"<table>", '<div class="scroll"><table>', html)
    html = re.sub(r"</table>", "</table></div>", html)
    html = re.sub(r"<th(?=[ >])(?! scope)", '<th scope="col"', html)
    for i, block in enumerate(blocks):
        place = PLACE.format(i)
        html = html.replace(f"<p>{place}</p>", block).replace(place, block)
    return html, headings
