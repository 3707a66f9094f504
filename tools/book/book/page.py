"""The page around the text: contents, style, script, and the policy that lets nothing else in."""

import base64
import hashlib
import re

from book.html import escape, link


def _hash(text):
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def _contents(chapters):
    out = []
    part = None
    for one in chapters:
        if one.part != part:
            if part is not None:
                out.append("</ul>")
            part = one.part
            out.append(f'<p class="part">{escape(part)}</p>' if part else "")
            out.append("<ul>")
        sections = "".join(f"<li>{link(anchor, escape(text))}</li>"
                           for level, anchor, text in one.headings if level == 2)
        inner = f"<ul>{sections}</ul>" if sections else ""
        out.append(f"<li>{link(one.anchor, escape(one.title))}{inner}</li>")
    return "\n".join(out) + "\n</ul>"


def _follow(chapters, i):
    """To the chapters before and after."""
    before = link(chapters[i - 1].anchor, f"← {escape(chapters[i - 1].title)}") if i else "<span>"\
        "</span>"
    after = link(chapters[i + 1].anchor, f"{escape(chapters[i + 1].title)} →") \
        if i + 1 < len(chapters) else "<span></span>"
    return f'<div class="follow">{before}{after}</div>'


def anchors(template):
    """Those that the page itself has."""
    return re.findall(r'\bid="([^"]+)"', template)


def assemble(folder, chapters, styles, version):
    """The whole page; `styles` are those that drawings need."""
    template, style, script = ((folder / name).read_text(encoding="utf-8").strip()
                               for name in ("page.html", "style.css", "book.js"))
    style = "\n".join([style, *filter(None, styles)])
    text = "\n".join(f'<article class="chapter" aria-labelledby="{escape(one.anchor)}">\n{one.html}'
                     f"\n{_follow(chapters, i)}\n</article>" for i, one in enumerate(chapters))
    policy = "; ".join(["default-src 'none'", f"style-src {_hash(style)}",
                        f"script-src {_hash(script)}", "img-src data:", "base-uri 'none'",
                        "form-action 'none'"])
    holes = {"POLICY": policy, "STYLE": style, "SCRIPT": script, "CONTENTS": _contents(chapters),
             "TEXT": text, "VERSION": escape(version)}
    # Once over the template, so that nothing in the text is taken for a hole.
    return re.sub(r"@([A-Z]+)@", lambda found: holes[found[1]], template) + "\n"
