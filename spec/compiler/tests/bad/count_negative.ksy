# expect: 15:25: the count '10 - n' can be negative; it is -245 to 10; 'valid' can narrow what it
#   is made of
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
        type: u2
        repeat: expr
        repeat-expr: 10 - n
