#!/usr/bin/env python3
"""Makes the book: one HTML file that needs nothing else. See README.md beside this file.

Usage: make_book.py --rubric RUBRIC --rubricc RUBRICC --out FILE [--draft]

Exit codes: 0 made, 1 mistakes in the text (each with its place, on stderr), 2 usage, 3 a program
failed or a file cannot be written.
"""

import argparse
import pathlib
import subprocess
import sys

try:
    from book import chapters, check, page
    from book.directives import Directives
    from book.html import escape
    from book.mistakes import Mistakes
    from book.names import Names
    from book.project import Project
except ModuleNotFoundError as missing:
    sys.stderr.write(f"make_book.py: Python has no {missing.name}: the book needs the packages "
                     "python3-markdown, python3-yaml and graphviz\n")
    sys.exit(3)

HERE = pathlib.Path(__file__).resolve().parent


def external_list(links):
    items = "".join(f'<li><a href="{escape(one)}">{escape(one)}</a></li>' for one in links)
    return f"<ul>{items}</ul>" if items else "<p>None.</p>"


def make(project, folder, mistakes):
    """The book as text, and the links that lead out of it; the text is of no use after mistakes."""
    names = Names(project)
    book = chapters.read(folder, project.root, mistakes)
    directives = Directives(names, mistakes)
    for chapter in book:
        directives.survey(chapter)
    for chapter in book:
        chapters.render(chapter, directives.expand, names)
    template = (HERE / "page/page.html").read_text(encoding="utf-8")
    external = check.check(book, page.anchors(template), mistakes)
    for chapter in book:
        chapter.html = chapter.html.replace("@EXTERNAL_LINKS@", external_list(external))
    version = project.run("--version").strip()
    return page.assemble(HERE / "page", book, directives.styles, version), external


def main():
    parser = argparse.ArgumentParser(description="Makes the book, one HTML file.")
    parser.add_argument("--rubric", required=True, help="the program rubric")
    parser.add_argument("--rubricc", required=True, help="the program rubricc")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="the file to write")
    parser.add_argument("--chapters", type=pathlib.Path, default=HERE / "chapters",
                        help="the folder of the chapters (%(default)s)")
    parser.add_argument("--draft", action="store_true", help="write it in spite of mistakes")
    parser.add_argument("--project", type=pathlib.Path, default=HERE.parents[1],
                        help="the project's folder (%(default)s)")
    options = parser.parse_args()
    mistakes = Mistakes()
    try:
        project = Project(options.project, options.rubric, options.rubricc)
        text, external = make(project, options.chapters, mistakes)
        if mistakes:
            print("\n".join(mistakes.lines()), file=sys.stderr)
            if not options.draft:
                return 1
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(text, encoding="utf-8")
    except (OSError, RuntimeError, subprocess.CalledProcessError) as error:
        print(f"make_book.py: {error}", file=sys.stderr)
        return 3
    print(f"{options.out}: {len(text.encode()) // 1024} KiB, {len(external)} links lead out of it")
    for one in external:
        print(f"  {one}")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
