# expect: 13:18: '0b12' is not a number; decimal, 0x or 0b digits were expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u4
      - id: b
        type: u1
        if: n == 0b12
