# expect: 14:18: '99999999999999999999' is too large; at most 9007199254740991 was expected, which rules
#   of a u8 can name
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
