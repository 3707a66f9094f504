# expect: 12:17: the expression is too deep to evaluate; at most 8 values are kept
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
        size: n + (n + (n + (n + (n + (n + (n + (n + (n + 1))))))))
