# expect: 10:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: b8
