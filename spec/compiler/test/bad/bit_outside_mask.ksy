# expect: 10:15: b1 outside a mask; -mask: 8 or -mask: 16 was expected at the type
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: b1
