# expect: 16:26: a mask has only bits; type: b1 was expected
meta:
  id: bad
  endian: be
types:
  bits:
    -mask: 8
    seq:
      - {id: bit7, type: b1}
      - {id: bit6, type: b1}
      - {id: bit5, type: b1}
      - {id: bit4, type: b1}
      - {id: bit3, type: b1}
      - {id: bit2, type: b1}
      - {id: bit1, type: b1}
      - {id: bit0, type: u1}
