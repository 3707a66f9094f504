# expect: 11:13: 'a' has up to 131070 elements; the generated code takes at most 65535
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u2
      - id: a
        type: u2
        repeat: expr
        repeat-expr: n * 2
