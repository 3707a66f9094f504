# expect: 15:7: instance 'b' is neither peek nor interpretation; a number at pos, or a type over
#   size-eos bytes at pos was expected
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
        type: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
