"""Rules with their cases and coverage."""

import re

from book.html import code, escape, heading, link, table
from book.project import group_of


def _count(number, noun):
    return f"{number} {noun}" + ("" if number == 1 else "s")


class Rules:
    def __init__(self, names):
        self.names = names
        self.project = names.project
        self.uses = {}  # Rule to cases, those on lines of what must not happen apart.
        for use in self.project.case_uses:
            signs = self.uses.setdefault(use["requirement"], {False: [], True: []})
            signs[use["negative"]].append(use["case"])
        self.decided = {}
        for number, (_, _, text) in self.project.decisions.items():
            for rule in set(re.findall(r"\b[A-Z]\w*(?:-[A-Z0-9]+)+\b", text)):
                self.decided.setdefault(rule, []).append(number)
        self.messages = {}
        for full, one in self.project.types.items():
            for rule in {one.get("requirement")} | {field.get("requirement")
                                                    for field in one.get("fields", [])}:
                self.messages.setdefault(rule, []).append(full)

    def select(self, name):
        """The rules of a group (J4), a family (J) or one; empty if there is none."""
        rules = self.project.rules
        if name in rules:
            return [name]
        of_group = [one for one in rules if group_of(one) == name]
        return of_group or [one for one in rules if re.sub(r"\d+$", "", group_of(one)) == name]

    def entry(self, rule, level):
        one = self.project.rules[rule]
        roles = "".join(f'<span class="tag">{role}</span>' for role in one["roles"])
        title = (f'{escape(rule)}<span class="level {one["level"].lower()}">{one["level"]}</span>'
                 f'<span class="clause">{escape(one["clause"])}</span>{roles}')
        facts = []
        if "deployed" in one:
            facts.append(("Release 1.0", self.names.rich(one["deployed"])))
        for profile in self.project.profiles:
            if rule in profile["accepted"]:
                facts.append((f"Accepted ({profile['name']})",
                              self.names.rich(profile["accepted"][rule])))
        facts.append(("Source", self.names.rich(one["source"])))
        numbers = self.decided.get(rule, [])
        if numbers:
            facts.append(("Decisions", ", ".join(
                link(f"decision-{number}", escape(self.project.decisions[number][1]))
                for number in numbers)))
        if one["forbids"]:
            facts.append(("Kind", "says what must not happen; a case has to tempt it"))
        facts += self._checked_by(rule)
        rows = "".join(f"<dt>{escape(key)}</dt><dd>{value}</dd>" for key, value in facts)
        return (f'<section class="rule" data-find="{rule} rule">{heading(level, rule, title)}'
                f'<p class="sentence">{self.names.rich(one["sentence"])}</p>'
                f'<dl class="facts">{rows}</dl>{self._cases(rule)}</section>')

    def _checked_by(self, rule):
        if group_of(rule) == "WIRE":
            facts = []
            messages = self.messages.get(rule, [])
            if messages:
                facts.append(("Messages", ", ".join(map(self.names.type_link, messages))))
            vectors = self.project.vectors.get(rule)
            if vectors:
                facts.append(("Vectors", _count(vectors, "file") + " of bytes that break it"))
            return facts
        seen = self.project.coverage[rule]
        parts = []
        if seen["transitions"]:
            parts.append(_count(seen["transitions"], "step") + " of the reference machine")
        if seen["ignores"]:
            parts.append(_count(seen["ignores"], "refusal"))
        if seen["explored"]:
            parts.append("reached by the explorer")
        caught = "that breaks it, caught" if seen["mutants"] == 1 else "that break it, all caught"
        parts.append(f"{_count(seen['mutants'], 'mutant')} {caught}")
        return [("Coverage", ", ".join(parts))]

    def _cases(self, rule):
        signs = self.uses.get(rule)
        if not signs:
            return ""
        tempting = set(signs[True])
        shown = list(dict.fromkeys(signs[False] + signs[True]))
        items = []
        for name in shown:
            sign = '<span class="tag">tempts it</span>' if name in tempting else ""
            comment = self.names.rich(self.project.cases[name].get("comment", ""))
            items.append(f"<li>{link(name, code(name))}{sign} {comment}</li>")
        words = _count(len(shown), "golden trace")
        if len(tempting) == len(shown):
            words += ", which tempts it" if len(shown) == 1 else ", all of which tempt it"
        elif tempting:
            words += f", {len(tempting)} of which tempt{'s' if len(tempting) == 1 else ''} it"
        return (f"<details{' open' if len(shown) < 4 else ''}><summary>{words}</summary>"
                f'<ul class="cases">{"".join(items)}</ul></details>')

    def index(self):
        rows = []
        for rule, one in self.project.rules.items():
            signs = self.uses.get(rule, {False: [], True: []})
            cases = len(set(signs[False] + signs[True]))
            rows.append(("", "", [
                link(rule, escape(rule)), one["level"], ", ".join(one["roles"]) or "all",
                escape(one["sentence"]), str(cases or self.project.vectors.get(rule, ""))]))
        return table(["rule", "level", "for", "sentence", "cases or vectors"], rows,
                     f"All {len(rows)} rules", "index")

    def coverage(self):
        groups = {}
        for rule in self.project.rules:
            groups.setdefault(group_of(rule), []).append(rule)
        rows = []
        for group, rules in groups.items():
            ones = [self.project.rules[rule] for rule in rules]
            areas = {}  # "wire, radio" is the part radio of wire.
            for one in ones:
                area, _, part = one["clause"].partition(", ")
                areas.setdefault(area, {})[part] = None
            clauses = [f"{area}: {', '.join(parts)}" for area, parts in areas.items()]
            uses = [self.uses.get(rule, {False: [], True: []}) for rule in rules]
            seen = [self.project.coverage.get(rule, {}) for rule in rules]
            rows.append([
                link(rules[0], escape(group)), escape("; ".join(clauses)),
                str(sum(one["level"] == "MUST" for one in ones)),
                str(sum(one["level"] != "MUST" for one in ones)),
                str(len({case for one in uses for case in one[False] + one[True]}) or ""),
                str(len({case for one in uses for case in one[True]}) or ""),
                str(sum(one.get("mutants", 0) for one in seen) or ""),
                str(sum(self.project.vectors.get(rule, 0) for rule in rules) or "")])
        return table(["group", "of", "MUST", "other", "cases", "tempting", "mutants", "vectors"],
                     rows, "Rules by group, and what checks them", "counts")
