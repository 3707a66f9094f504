"""Messages: the picture of their bytes, their fields, what leads to them, masks and enums."""

from book.html import code, escape, heading, link, table
from book.picture import picture


def size_text(size):
    """'4', '2 to 102', '0 and more'."""
    if "max" not in size:
        return f"{size['min']} and more"
    return str(size["min"]) if size["min"] == size["max"] else f"{size['min']} to {size['max']}"


def _number(field):
    sign = {"unsigned": "u", "signed": "s", "float": "f"}[field["kind"]]
    order = ", little-endian" if field["width_bytes"] > 1 and field["little_endian"] else ""
    return f"{code(sign + str(8 * field['width_bytes']))}{order}"


def short_type(field):
    """For the picture: 'u16', 'mask16', 'r_addr', 'bytes'."""
    kind = field["kind"]
    if kind in ("unsigned", "signed", "float"):
        text = kind[0] + str(8 * field["width_bytes"])
    elif kind == "mask":
        text = f"mask{8 * field['width_bytes']}"
    else:
        text = field["type"].split("::")[1] if "type" in field else "bytes"
    return text + ("[]" if "repeat" in field else "")


class Wire:
    def __init__(self, names):
        self.names = names
        self.project = names.project
        self.dispatched = set()  # Carriers whose dispatch a chapter shows.

    def _choice(self, choice):
        cases = "".join(f"<li>{code(one['value'])}: {self.names.type_link(one['type'])}</li>"
                        for one in choice["cases"])
        other = self.names.type_link(choice["otherwise"]) if "otherwise" in choice \
            else "opaque bytes"
        return f"by {code(choice['key'])}<ul class=\"choice\">{cases}<li>else {other}</li></ul>"

    def _type(self, field):
        kind = field["kind"]
        if kind == "bytes":
            text = "bytes"
        elif kind == "mask":
            text = f"mask {self.names.type_link(field['type'])}"
        elif kind == "struct":
            text = self._choice(field["choice"]) if "choice" in field \
                else self.names.type_link(field["type"])
        else:
            text = _number(field)
        if field.get("repeat") == "count":
            text += f" × {code(field['count'])}"
        if field.get("repeat") == "to_end":
            text += ", repeated to the end"
        if "size_expr" in field:
            text += f", {code(field['size_expr'])} bytes"
        if field.get("to_end"):
            text += ", to the end"
        if "if" in field:
            text += f", only if {code(field['if'])}"
        return text

    def _values(self, field):
        out = []
        if "enum" in field:
            out.append(self.names.enum_link(field["enum"]))
        valid = field.get("valid", {})
        if "one_of" in valid:
            out.append(", ".join(map(str, valid["one_of"])))
        elif valid:
            out.append(f"{valid.get('min', '')} to {valid.get('max', '')}")
        if "expect" in field:
            out.append(f"{field['expect']} expected")
        if "unit" in field:
            unit = field["unit"]
            if unit["scale"] == 1 and unit["offset"] == 0:
                out.append(escape(unit["symbol"]))
            else:
                sign = "-" if unit["offset"] < 0 else "+"
                out.append(escape(f"{unit['scale']:g} × raw {sign} {abs(unit['offset']):g} "
                                  f"{unit['symbol']}"))
        return "; ".join(out)

    def _rows(self, one, base, depth, prefix):
        """Rows of the table of fields. What a structure of a fixed size holds comes under it."""
        for field in one["fields"]:
            offset = base + field["offset"] if base is not None and "offset" in field else None
            name = code(prefix + field["id"])
            cells = [name, "varies" if offset is None else str(offset),
                     size_text(field["size"]), self._type(field), self._values(field),
                     self.names.rich(field.get("doc", "")),
                     self.names.rule_link(field.get("requirement", "")) if depth == 0 else ""]
            yield "", "inner" if depth else "", cells
            inner = self.project.types.get(field.get("type"), {})
            if depth == 0 and inner.get("fields") and "repeat" not in field \
                    and inner["size"]["min"] == inner["size"].get("max"):
                yield from self._rows(inner, offset, 1, prefix + field["id"] + ".")

    def _carried(self, full):
        """Returns the routes to the type in words."""
        out = []
        for one in self.project.reached.get(full, []):
            if "carrier" in one:
                number = ", ".join(map(str, one["am_types"]))
                out.append(f"AM type {number} on {escape(one['carrier'])}")
                continue
            host = self.names.find("layout", f"{full.split('::')[0]}::{one['in']}")
            text = f"{code(one['field'])} of {self.names.type_link(host)}"
            if one["if"]:
                text += f" if {code(one['if'])}"
            if one["key"]:
                values = " or ".join(map(str, one["values"])) or "anything else"
                text += f"{' and' if one['if'] else ' if'} {escape(one['key'])} is {values}"
            out.append(text)
        return out

    def _facts(self, full, one):
        facts = [f"<dt>Size</dt><dd>{size_text(one['size'])} bytes</dd>"]
        if one["am_types"]:
            numbers = ", ".join(f"{value} ({value:#04x})" for value in one["am_types"])
            facts.append(f"<dt>AM type</dt><dd>{numbers}</dd>")
        carried = self._carried(full)
        if carried:
            items = "".join(f"<li>{item}</li>" for item in carried)
            facts.append(f"<dt>Reached as</dt><dd><ul>{items}</ul></dd>")
        if "carrier" in one:
            carrier = one["carrier"]
            facts.append(f"<dt>Carrier</dt><dd>{link('dispatch-' + carrier, escape(carrier))}</dd>"
                         if carrier in self.dispatched and one["spec"] == "rubicon" else
                         f"<dt>Carrier</dt><dd>{escape(carrier)}</dd>")
        if "requirement" in one:
            facts.append(f"<dt>Rule</dt><dd>{self.names.rule_link(one['requirement'])}</dd>")
        if "doc_ref" in one:
            facts.append(f"<dt>Source</dt><dd>{escape(one['doc_ref'])}</dd>")
        vectors = self.project.vectors.get(full)
        if vectors:
            facts.append(f"<dt>Vectors</dt><dd>{vectors} with valid bytes</dd>")
        return f'<dl class="facts">{"".join(facts)}</dl>'

    def _title(self, full, anchor, level, extra=""):
        spec, short = full.split("::")
        kind = f'<span class="tag">{extra}</span>' if extra else ""
        other = f'<span class="tag">{spec}</span>' if spec != "rubicon" else ""
        return heading(level, anchor, f"<code>{short}</code>{kind}{other}", "entry")

    def layout(self, full, level):
        one = self.project.types[full]
        anchor = self.names.anchors["layout"][full]
        rows = list(self._rows(one, 0, 0, ""))
        doc = f"<p>{self.names.rich(one['doc'])}</p>" if "doc" in one else ""
        parts = [self._title(full, anchor, level), doc, self._facts(full, one),
                 picture(self.project, full, short_type),
                 table(["field", "offset", "bytes", "type", "values", "meaning", "rule"], rows,
                       f"Fields of {one['id']}", "fields")]
        if "interpretations" in one:
            parts.append(table(
                ["what", "in place of", "if", "type", "meaning"],
                [[code(each["name"]), code(each["overlays"]), code(each.get("if", "always")),
                  self._choice(each["choice"]) if "choice" in each
                  else self.names.type_link(each["type"]), self.names.rich(each.get("doc", ""))]
                 for each in one["interpretations"]],
                f"The opaque bytes of {one['id']}: the first that fits"))
        return f'<section class="message" data-find="{one["id"]} message">' + \
            "\n".join(parts) + "</section>"

    def mask(self, full, level):
        one = self.project.types[full]
        width = len(one["bits"])
        rows = [[str(bit["bit"]), f"{1 << bit['bit']:#0{2 + width // 4}x}",
                 code(bit["name"]) if "name" in bit else '<span class="soft">unnamed</span>']
                for bit in reversed(one["bits"])]
        doc = f"<p>{self.names.rich(one['doc'])}</p>" if "doc" in one else ""
        return (f'<section class="message" data-find="{one["id"]} mask">'
                f'{self._title(full, self.names.anchors["mask"][full], level, "mask")}{doc}'
                + table(["bit", "value", "name"], rows, f"Bits of {one['id']}", "values")
                + "</section>")

    def enum(self, full, level):
        one = self.project.enums[full]
        has_doc = any("doc" in entry for entry in one["entries"])
        rows = [[code(entry["name"]), str(entry["value"]), f"{entry['value']:#04x}"]
                + ([self.names.rich(entry.get("doc", ""))] if has_doc else [])
                for entry in one["entries"]]
        columns = ["name", "value", "hex"] + (["meaning"] if has_doc else [])
        return (f'<section class="message" data-find="{one["id"]} enum">'
                f'{self._title(full, self.names.anchors["enum"][full], level, "enum")}'
                + table(columns, rows, f"Values of {one['id']}", "values") + "</section>")

    def dispatch(self, carrier):
        """Returns the routes from the frames of a carrier, as nested lists."""
        full = next(name for name, one in self.project.types.items()
                    if one.get("carrier") == carrier)
        return (f'<div class="tree" id="dispatch-{carrier}">{self._tree(full, set())}</div>')

    def _tree(self, full, seen):
        one = self.project.types[full]
        items = []
        for field in [*one.get("fields", []), *one.get("interpretations", [])]:
            items += self._branch(field, "overlays" in field, seen)
        return f"<ul>{''.join(items)}</ul>" if items else ""

    def _branch(self, field, is_instance, seen):
        condition = f"if {code(field['if'])}: " if "if" in field else ""
        if "choice" not in field:
            return [self._leaf(condition, field["type"], seen)] if is_instance else []
        choice = field["choice"]
        items = [self._leaf(f"{code(choice['key'] + ' == ' + one['value'])}: ", one["type"], seen)
                 for one in choice["cases"]]
        items.append(self._leaf("else: ", choice["otherwise"], seen)
                     if "otherwise" in choice else "<li>else: opaque bytes</li>")
        if condition:
            return [f"<li>{condition}<ul>{''.join(items)}</ul></li>"]
        return items

    def _leaf(self, before, full, seen):
        first = full not in seen
        seen.add(full)
        more = self._tree(full, seen) if first else ""
        return f"<li>{before}{self.names.type_link(full)}{more}</li>"
