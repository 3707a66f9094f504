"""The picture of a message's bytes: eight in a row, a cell a field; wider where it varies."""

from book.html import escape

ROW_BYTES = 8
CELL = 84  # Of a byte, in units of the picture.
HEIGHT = 46
MARGIN = 40  # For the offsets.


def _leaves(project, full, prefix=""):
    """Yields (path, field) of the bytes; opens structures of a fixed size."""
    for field in project.types[full]["fields"]:
        inner = project.types.get(field.get("type"), {})
        fixed = inner.get("fields") and "repeat" not in field \
            and inner["size"]["min"] == inner["size"].get("max")
        if fixed:
            yield from _leaves(project, field["type"], prefix + field["id"] + ".")
        else:
            yield prefix + field["id"], field


def _parts(size_bytes, column):
    """The pieces of a field in rows: (column, width) each."""
    while size_bytes > 0:
        width = min(size_bytes, ROW_BYTES - column)
        yield column, width
        size_bytes -= width
        column = (column + width) % ROW_BYTES


def _css(field):
    if "enum" in field:
        return "enum"
    return {"mask": "mask", "struct": "inside", "bytes": "inside"}.get(field["kind"], "number")


class _Picture:
    def __init__(self):
        self.out = []
        self.row = 0
        self.column = 0
        self.offset = 0  # None behind what varies.

    def _cell(self, column, width, css, lines):
        x = MARGIN + column * CELL
        y = self.row * (HEIGHT + 6) + 1
        self.out.append(f'<rect class="cell {css}" x="{x}" y="{y}" width="{width * CELL - 4}" '
                        f'height="{HEIGHT}" rx="4"/>')
        middle = x + (width * CELL - 4) / 2
        for i, (name, text) in enumerate(lines):
            fits = max(4, int((width * CELL - 10) / (7.3 if name == "name" else 6.4)))
            if len(text) > fits:
                text = "…" + text[-(fits - 1):]
            at = y + (20 if i == 0 and len(lines) > 1 else 37 if i else 28)
            self.out.append(f'<text class="{name}" x="{middle:g}" y="{at}" '
                            f'text-anchor="middle">{escape(text)}</text>')

    def _offset(self):
        text = "…" if self.offset is None else str(self.offset)
        y = self.row * (HEIGHT + 6) + 28
        self.out.append(f'<text class="at" x="{MARGIN - 10}" y="{y}" '
                        f'text-anchor="end">{text}</text>')

    def finish_row(self):
        if self.column:
            self.row += 1
            self.column = 0

    def varying(self, path, size, text):
        """A row of its own, for what has no fixed size or is longer than two rows."""
        self.finish_row()
        self._offset()
        self._cell(0, ROW_BYTES, "inside", [("name", path), ("type", text)])
        self.row += 1
        fixed = size["min"] == size.get("max")
        self.offset = self.offset + size["min"] if fixed and self.offset is not None else None

    def fixed(self, path, size_bytes, css, text):
        first = True
        for column, width in _parts(size_bytes, self.column):
            if column == 0:
                self._offset()
            lines = [("name", path), ("type", text)] if first else [("type", "…")]
            self._cell(column, width, css, lines)
            first = False
            self.offset = None if self.offset is None else self.offset + width
            self.column = column + width
            if self.column == ROW_BYTES:
                self.finish_row()


def picture(project, full, short_type):
    drawing = _Picture()
    spoken = []
    for path, field in _leaves(project, full):
        size = field["size"]
        shown = short_type(field)
        varies = size["min"] != size.get("max")
        if varies or size["min"] > 2 * ROW_BYTES:
            span = f"{size['min']} to {size['max']}" if varies and "max" in size \
                else f"{size['min']} and more" if varies else str(size["min"])
            drawing.varying(path, size, f"{shown}, {span} bytes")
            spoken.append(f"{path} {span}")
        else:
            drawing.fixed(path, size["min"], _css(field), shown)
            spoken.append(f"{path} {size['min']}")
    drawing.finish_row()
    width = MARGIN + ROW_BYTES * CELL
    height = drawing.row * (HEIGHT + 6)
    label = f"Bytes of {full.split('::')[1]}: {', '.join(spoken)}. The table says the same."
    return (f'<div class="scroll"><svg class="bytes" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" role="img" aria-label="{escape(label)}">'
            + "".join(drawing.out) + "</svg></div>")
