# expect: 10:13: the bits 'a' end within a byte; 3 more were expected
# expect: 11:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: b5
      - id: b
        type: u1
