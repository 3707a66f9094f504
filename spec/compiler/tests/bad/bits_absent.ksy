# expect: 12:13: the bits 'b' repeat or may be absent; bits that are always there, once, were expected
# expect: 13:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        type: b8
        if: a == 1
