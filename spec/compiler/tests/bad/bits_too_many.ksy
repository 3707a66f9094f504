# expect: 11:15: a number of 33 bits; 1 to 32 were expected
# expect: 11:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: b33
