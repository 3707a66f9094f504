# expect: 15:24: a count that is not a number: 'n < 4'; a number was expected; .to_i makes one of an
#   enum
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
        repeat: expr
        repeat-expr: n < 4
