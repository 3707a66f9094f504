# expect: 9:23: the size '-1' is always negative; a field has bytes
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, size: -1}
