meta:
  id: bad
  endian: be
types:
  peek_of_float:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: rest, size-eos: true}
    instances:
      # expect: 7: peek 'b' is not an unsigned number; an instance is a number at pos, or a type
      #   over size-eos bytes at pos
      b:
        pos: 1
        type: f4
  position_not_a_number:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      # expect: 7: instance 'peek' is computed; a number or a type at pos was expected
      peek:
        pos: abc
        type: u1
