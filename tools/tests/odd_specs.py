"""Specs that the tests of `--spec` and those of Wireshark's dissector share."""

UNPROVED = """meta: {id: unproved, endian: be}
seq:
  - {id: length, type: u1}
  - {id: kind, type: u1}
  - {id: body, size: length - 2}
  - {id: chosen, type: {switch-on: kind, cases: {1: pair, 2: list}}}
  - {id: lists, type: list, repeat: eos}
instances:
  twice: {value: length * 2}
types:
  pair:
    seq: [{id: default, type: u1, enum: color}, {id: empty, type: nothing}]
    types:
      nothing: {}
    enums:
      color: {1: red}
  list:
    seq: [{id: count, type: u1}, {id: values, type: u2, repeat: expr, repeat-expr: count}]
"""

FLOATING = """meta: {id: floating, endian: be, encoding: ASCII}
seq:
  - {id: name, type: strz}
  - {id: n, type: u1}
  - {id: values, type: u2, repeat: expr, repeat-expr: n}
  - {id: len_body, type: u2le}
  - {id: body, size: len_body}
  - {id: high, type: b4}
  - {id: kind, type: b4}
  - {id: chosen, type: {switch-on: kind, cases: {1: pair}}}
  - {id: tail, size: high * 2 - n, if: kind != 0}
types:
  pair: {seq: [{id: a, type: u1}, {id: b, type: u1}]}
"""
