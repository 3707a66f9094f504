"""Diagrams of the book, drawn by the program itself: sequence charts from golden traces, state
diagrams from the transitions that the reference machine makes.

All are SVG elements to be put into a page as they are: no XML prolog, ids that begin with the
diagram's name, the page's text colour. They may be wider than the page: let what holds them scroll.
"""

import re
import subprocess


def run(rubric, *words):
    """Standard output of the program; RuntimeError with what it says where it fails."""
    done = subprocess.run([rubric, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"rubric {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout


def with_links(svg, rule_href):
    """Makes each rule in a chart a link to rule_href(rule)."""
    return re.sub(r'<tspan class="rc-rule">([^<]+)</tspan>',
                  lambda m: f'<a href="{rule_href(m[1])}"><tspan class="rc-rule">{m[1]}</tspan></a>',
                  svg)


def chart_svg(rubric, case_id, rule_href=None):
    """The sequence chart of a golden trace. `rule_href(rule)`, if given, says where a rule's id
    leads to. RuntimeError for a case that there is not."""
    svg = run(rubric, "chart", case_id, "--format", "svg")
    return with_links(svg, rule_href) if rule_href else svg
