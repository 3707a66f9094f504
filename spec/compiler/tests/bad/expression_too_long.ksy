# expect: 13:11: the expression is too long; at most 1000 characters are read
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: b
        size:
          n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
