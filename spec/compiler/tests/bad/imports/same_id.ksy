meta:
  id: bad
  endian: be
types:
  other:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
