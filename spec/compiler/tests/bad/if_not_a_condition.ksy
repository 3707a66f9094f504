# expect: 13:13: 'if' is not a condition; a comparison was expected
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
        type: u1
        if: n
