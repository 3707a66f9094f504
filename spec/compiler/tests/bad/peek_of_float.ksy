# expect: 15:7: peek 'b' is not an unsigned number; an instance is a number at pos, or a type over
#   size-eos bytes at pos
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: rest
        size-eos: true
    instances:
      b:
        pos: 1
        type: f4
