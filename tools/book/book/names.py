"""Names in the book, the anchor of each, and the links that text gets by itself."""

import re

from book.html import code, escape, link

RULE = r"\b[A-Z][A-Z0-9]*(?:-[A-Z0-9]+)+\b"
DECISION = r"\b[Dd]ecision\s(\d{3})\b"
_TICKED = re.compile(r"`([^`]+)`")


class Names:
    """Anchors by kind and name. Of types and enums that share a name, the first in order of specs
    has it as its anchor; the others have theirs with the spec before it."""

    KINDS = ("layout", "mask", "enum", "rules", "case")

    def __init__(self, project):
        self.project = project
        self.anchors = {kind: {} for kind in self.KINDS}
        taken = set()
        types = {name: "mask" if "bits" in one else "layout"
                 for name, one in project.types.items()}
        for name, kind in [*types.items(), *((name, "enum") for name in project.enums)]:
            short = name.split("::")[1]
            anchor = short if short not in taken else name.replace("::", "-")
            taken.add(anchor)
            self.anchors[kind][name] = anchor
        self.anchors["rules"] = {name: name for name in project.rules}
        self.anchors["case"] = {name: name for name in project.cases}
        self._by_text = self._texts()

    def find(self, kind, name):
        """Returns the full name of a short or full one; none if there is no such thing."""
        known = self.anchors[kind]
        if name in known:
            return name
        return next((one for one in known if one.split("::")[-1] == name), None)

    def _texts(self):
        """Maps inline code to the anchor that it links to. A word alone may mean anything else."""
        out = {}
        for kind in self.KINDS:
            for name, anchor in self.anchors[kind].items():
                short = name.split("::")[-1]
                if kind in ("rules", "case") or "_" in short:
                    out.setdefault(short, anchor)
                if "::" in name:
                    out[name] = anchor
        return out

    def anchor_of_code(self, text):
        return self._by_text.get(text)

    def type_link(self, full):
        kind = "mask" if full in self.anchors["mask"] else "layout"
        return link(self.anchors[kind][full], code(full.split("::")[1]))

    def enum_link(self, full):
        return link(self.anchors["enum"][full], code(full.split("::")[1]))

    def rule_link(self, rule):
        return link(rule, escape(rule)) if rule in self.anchors["rules"] else escape(rule)

    def rich(self, text):
        """Plain text as HTML, in which rules, decisions and what is between backticks are what
        they are in a chapter."""
        out = []
        for i, part in enumerate(_TICKED.split(text)):
            if i % 2 == 1:
                anchor = self.anchor_of_code(part)
                out.append(link(anchor, code(part)) if anchor else code(part))
                continue
            part = escape(part)
            part = re.sub(RULE, lambda found: self.rule_link(found[0]), part)
            out.append(re.sub(DECISION, self._decision, part))
        return "".join(out)

    def anchor_of_rule(self, found):
        return found[0] if found[0] in self.project.rules else None

    def anchor_of_decision(self, found):
        return f"decision-{found[1]}" if int(found[1]) in self.project.decisions else None

    def _decision(self, found):
        anchor = self.anchor_of_decision(found)
        return link(anchor, found[0]) if anchor else found[0]
