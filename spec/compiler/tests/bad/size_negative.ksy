# expect: 14:17: the size 'n - 3' can be negative; it is -1 to 252; 'valid' can narrow what it is
#   made of
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
        valid: {min: 2}
      - id: b
        size: n - 3
