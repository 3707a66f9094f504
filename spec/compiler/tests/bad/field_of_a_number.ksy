# expect: 12:15: 'n' has no fields to read; it is not a structure
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: b
        size: n.x
