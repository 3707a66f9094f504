# expect: 17:5: instances in a mask; a mask has only bits
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
      - {id: b0, type: b1}
    instances: {}
