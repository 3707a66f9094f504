# expect: 9:9: a field without id; id: was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - type: u1
