"""`{{text PATH}}` in a chapter: a Markdown file of the project as part of it. A link to another
file of the project becomes the file's name, since the book is read where the project is not."""

import posixpath
import re

_TEXT = re.compile(r"\{\{text (\S+)\}\}")
_FENCE = re.compile(r"\s*```")
_LINK = re.compile(r"\[([^\]]*)\]\((?!https?://|#)([^)#\s]+)(?:#[^)]*)?\)")


def lines_of(path, root, mistakes):
    """The lines of a chapter's file, with those of the texts that it names."""
    out = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = _TEXT.fullmatch(line.strip())
        if not found:
            out.append(line)
        elif (root / found[1]).is_file():
            out += _freed(root, found[1])
        else:
            file = path.relative_to(root) if path.is_relative_to(root) else path.name
            mistakes.add(str(file), number, f"no file of the project is called '{found[1]}'; "
                         "expected a path from the project's folder")
    return out


def _freed(root, name):
    folder = posixpath.dirname(name)

    def named(link):
        target = posixpath.normpath(posixpath.join(folder, link[2]))
        words = link[1].strip("`")
        return f"`{target}`" if target.endswith(words) else f"{link[1]} (`{target}`)"

    fenced = False
    for line in (root / name).read_text(encoding="utf-8").splitlines():
        fenced ^= bool(_FENCE.match(line))
        yield line if fenced else _LINK.sub(named, line)
