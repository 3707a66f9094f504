# expect: 16:9: a bit without id; id: was expected
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
      - {type: b1}
