"""Pieces of HTML. What comes from outside is escaped here."""

import html
import re

escape = html.escape
_slugs = re.compile(r"[^a-z0-9]+")


def slug(text):
    """The anchor of a heading: 'From a serial line' is 'from-a-serial-line'."""
    return _slugs.sub("-", text.lower()).strip("-")


def code(text):
    return f"<code>{escape(str(text))}</code>"


def link(anchor, inner):
    """`inner` is HTML already."""
    return f'<a href="#{escape(anchor)}">{inner}</a>'


def table(columns, rows, caption="", name=""):
    """A table whose cells are HTML; a row is a list of cells, or (anchor, class, cells). The first
    cell of a row is its header."""
    out = ['<div class="scroll">', f'<table class="{name}">' if name else "<table>"]
    if caption:
        out.append(f"<caption>{escape(caption)}</caption>")
    heads = "".join(f'<th scope="col">{escape(one)}</th>' for one in columns)
    out.append(f"<thead><tr>{heads}</tr></thead>\n<tbody>")
    for row in rows:
        anchor, css, cells = row if isinstance(row, tuple) else ("", "", row)
        attributes = (f' id="{escape(anchor)}"' if anchor else "") + \
            (f' class="{css}"' if css else "")
        rest = "".join(f"<td>{cell}</td>" for cell in cells[1:])
        out.append(f'<tr{attributes}><th scope="row">{cells[0]}</th>{rest}</tr>')
    out.append("</tbody>\n</table></div>")
    return "\n".join(out)


def heading(level, anchor, inner, css=""):
    """A heading that can be linked to; `inner` is HTML already."""
    css = f' class="{css}"' if css else ""
    return f'<h{level} id="{escape(anchor)}"{css}>{inner}{mark(anchor)}</h{level}>'


def mark(anchor):
    """Returns the link to a place, to be copied; shown under the pointer and in focus."""
    return (f'<a class="mark" href="#{escape(anchor)}" aria-label="Link to this place">'
            '<span aria-hidden="true">#</span></a>')


def plain(inner):
    """The text of a piece of HTML."""
    return html.unescape(re.sub(r"<[^>]*>", "", inner))
