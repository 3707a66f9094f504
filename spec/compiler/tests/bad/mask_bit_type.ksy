# expect: 16:24: a mask has only bits; type: b1 was expected
meta:
  id: bad
  endian: be
types:
  bits:
    -mask: 8
    seq:
      - {id: b7, type: b1}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      - {id: b0, type: u1}
