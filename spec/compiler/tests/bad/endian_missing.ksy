# expect: 8:23: no byte order for 'u2'; meta: endian, or the suffix be or le was expected
meta:
  id: bad
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u2}
