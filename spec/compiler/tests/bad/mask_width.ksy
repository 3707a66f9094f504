# expect: 7:12: a mask of 12 bits; 8 or 16 was expected
meta:
  id: bad
  endian: be
types:
  bits:
    -mask: 12
    seq:
      - {id: a, type: b1}
