"""Makes a drawing part of the page: unique identifiers, nothing that the page does not allow."""

import re

_REFUSED = re.compile(r"<style|<script|<foreignObject|<image|\son\w+=|\sstyle=|"
                      r"(?:xlink:)?href=\"(?!#)|<!ENTITY|url\((?!#)", re.I)


def fitted(svg, prefix):
    """(the <svg> element alone, its identifiers beginning with `prefix`; the text of its <style>,
    which is for the page's own). ValueError where it is none or has what the page does not allow.
    """
    found = re.search(r"<svg.*</svg>", svg, re.S)
    if not found:
        raise ValueError("the drawing is not an <svg> element")
    svg = re.sub(r"<!--.*?-->", "", found[0], flags=re.S)
    style = "\n".join(re.findall(r"<style>(.*?)</style>", svg, re.S))
    svg = re.sub(r"<style>.*?</style>\s*", "", svg, flags=re.S)
    refused = _REFUSED.search(svg)
    if refused:
        raise ValueError(f"the page allows no '{refused[0].strip()}' in a drawing")
    own = set(re.findall(r'\bid="([^"]+)"', svg))
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}\1"', svg)
    svg = re.sub(r'\bhref="#([^"]+)"', lambda m: f'href="#{prefix}{m[1]}"' if m[1] in own else m[0],
                 svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}\1)", svg)
    if "<a " in svg:  # An image has nothing in it that one could follow.
        svg = svg.replace('role="img"', 'role="group"', 1)
    svg = re.sub(r'(aria-(?:labelledby|describedby))="([^"]+)"',
                  lambda m: f'{m[1]}="' + " ".join(prefix + one for one in m[2].split()) + '"', svg)
    return svg, style
