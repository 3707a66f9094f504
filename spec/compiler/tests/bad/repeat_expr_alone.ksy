# expect: 11:9: repeat-expr without repeat: expr
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        repeat-expr: 4
