# expect: 14:15: 'n' is a list; a single number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
        repeat: expr
        repeat-expr: 2
      - id: b
        size: n
