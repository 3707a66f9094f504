"""Profiles and decisions."""

import posixpath
import re

from book.html import code, escape, heading, table


def profiles(names, level):
    project = names.project
    known = project.profiles
    rows = []
    for kind in ("constants", "switches"):
        for key in known[0][kind]:
            values = [one[kind][key] for one in known]
            shown = [("on" if value else "off") if kind == "switches" else str(value)
                     for value in values]
            differs = "differs" if len(set(values)) > 1 else ""
            if differs:
                shown[-1] += '<span class="tag">differs</span>'
            rows.append(("", differs, [code(key), *shown]))
    out = [table(["constant or switch", *[one["name"] for one in known]], rows,
                 "Constants and switches; rows in which profiles differ are marked", "profiles")]
    for one in known:
        anchor = f"profile-{one['name']}"
        out.append(heading(level, anchor, f"Profile {code(one['name'])}"))
        out.append(f"<p>{names.rich(one['doc'])}</p>")
        if one["accepted"]:
            out.append(table(["rule", "accepted instead"],
                             [[names.rule_link(rule), names.rich(text)]
                              for rule, text in one["accepted"].items()],
                             f"What {one['name']} accepts in place of a rule"))
    return "\n".join(out)


def without_files(text, file, project):
    """Markdown whose links to files are names of these, or links to what the book has of them."""
    numbers = {path: number for number, (path, _, _) in project.decisions.items()}

    def instead(found):
        path = posixpath.normpath(posixpath.join(posixpath.dirname(file), found[2]))
        if path in numbers:
            return f"[{found[1]}](#decision-{numbers[path]})"
        return f"{found[1]} (`{path}`)"

    return re.sub(r"\[([^\]]*)\]\((?!https?:|#)([^)]*)\)", instead, text)


def decisions(names, level, convert):
    """`convert` makes HTML of Markdown."""
    out = []
    for number, (file, title, text) in names.project.decisions.items():
        shown = f"{number}. {escape(title)}"
        out.append(f'<section class="decision" data-find="{number} {escape(title)} decision">'
                   + heading(level, f"decision-{number}", shown, "entry")
                   + convert(text, file) + "</section>")
    return "\n".join(out)
