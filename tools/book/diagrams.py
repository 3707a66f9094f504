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
                  lambda m: f'<a href="{rule_href(m[1])}">{m[0]}</a>', svg)


def chart_svg(rubric, case_id, rule_href=None):
    """The sequence chart of a golden trace. `rule_href(rule)`, if given, says where a rule's id
    leads to. RuntimeError for a case that there is not."""
    svg = run(rubric, "chart", case_id, "--format", "svg")
    return with_links(svg, rule_href) if rule_href else svg


# The parts of a node that have a state diagram, and what each shows.
STATES = {"join": "How a mote joins an island",
          "listing": "How a sink lists a mote",
          "message": "How a message ends at the mote that sent it",
          "output": "An output channel of synaptic communication",
          "input": "An input channel of synaptic communication",
          "mote_reception": "What a mote does about a message from its radio",
          "sink_reception": "What a sink does about a message from its radio"}

FONTS = "ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace"
STYLE = ("<style>"
         "svg.rubric-states:root{color-scheme:light dark;color:CanvasText;background:Canvas}"
         f".rubric-states text{{font-family:{FONTS};fill:currentColor}}"
         ".rubric-states .edge path{fill:none;stroke:currentColor}"
         ".rubric-states .edge polygon{fill:currentColor;stroke:currentColor}"
         ".rubric-states .node path,.rubric-states .node polygon,.rubric-states .node polyline"
         "{fill:none;stroke:currentColor}"
         ".rubric-states .node ellipse{fill:currentColor;stroke:currentColor}"
         "</style>")


def states_svg(rubric, name, rule_href=None):
    """The state diagram of a part of a node, one of STATES, as the machine makes its transitions.
    Graphviz places it. KeyError for a part that there is not, RuntimeError where either program
    fails."""
    title = STATES[name]
    dot = run(rubric, "explore", "--transitions", "--part", name, "--format", "dot")
    done = subprocess.run(["dot", "-Tsvg"], input=dot, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"dot: {done.stderr.strip()}")
    return cleaned(done.stdout, name, title, rule_href)


def cleaned(svg, name, title, rule_href=None):
    """Returns a drawing of Graphviz for a page: without prolog, colours and fonts of its own,
    ids that begin with the diagram's name, and a title."""
    prefix = f"states-{name}"
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<!--.*?-->\n?", "", svg, flags=re.S)
    head = re.match(r'<svg width="([\d.]+)pt" height="([\d.]+)pt"\s+viewBox="([^"]+)"[^>]*>', svg)
    if head is None:
        raise RuntimeError("dot: its SVG does not begin as expected")
    width, height = (round(float(text)) for text in head.groups()[:2])
    body = svg[head.end():].replace("&#45;", "-")
    body = re.sub(r"<title>[^<]*</title>\n?", "", body)
    body = re.sub(r"<a [^>]*>|</a>", "", body)
    body = re.sub(r' (fill|stroke|font-family)="[^"]*"', "", body)
    body = re.sub(r'<g id="[^"]*" class="(\w+)"', r'<g class="\1"', body)
    body = re.sub(r"<g id=\"[^\"]*\">\n?((?:(?!<g).)*?)</g>\n?", r"\1", body, flags=re.S)
    if rule_href:
        body = re.sub(r"\b[JNTS]\d+-[A-Z-]+\b",
                      lambda m: f'<a href="{rule_href(m[0])}"><tspan class="rc-rule">{m[0]}'
                                "</tspan></a>", body)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" class="rubric-states" role="img" '
            f'aria-labelledby="{prefix}-title" width="{width}" height="{height}" '
            f'viewBox="{head[3]}">\n<title id="{prefix}-title">{title}</title>\n{STYLE}\n{body}')
