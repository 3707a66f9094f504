# expect: 12:15: the size '0' is always 0; a field has bytes
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
        size: 0
