# expect: 14:18: '99999999999999999999' is not a number; decimal, 0x or 0b digits of a 64-bit number were
#   expected
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
        if: n == 99999999999999999999
