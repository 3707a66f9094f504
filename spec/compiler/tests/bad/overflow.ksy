# expect: 12:17: 'n * n' can overflow 64 bits; smaller numbers were expected
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
        size: n * n * n
