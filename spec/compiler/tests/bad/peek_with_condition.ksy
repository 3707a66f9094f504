# expect: 15:15: peek 'b' has a condition; conditions belong to interpretations
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
    instances:
      b:
        pos: 0
        type: u1
        if: a == 1
