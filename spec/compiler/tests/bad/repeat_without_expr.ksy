# expect: 11:17: repeat: expr without a count; repeat-expr: was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        repeat: expr
