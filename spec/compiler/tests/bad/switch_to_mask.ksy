# expect: 16:13: 'bits' is a mask; a case chooses a structure
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: bits
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
      - {id: bit0, type: b1}
