# expect: 7:12: 7 bits in a mask of 8; each bit is named once, from the highest down
meta:
  id: bad
  endian: be
types:
  bits:
    -mask: 8
    seq:
      - {id: bit6, type: b1}
      - {id: bit5, type: b1}
      - {id: bit4, type: b1}
      - {id: bit3, type: b1}
      - {id: bit2, type: b1}
      - {id: bit1, type: b1}
      - {id: bit0, type: b1}
