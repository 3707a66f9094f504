# expect: 12:7: instance 'peek' is computed; a number or a type at pos was expected
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
      peek:
        pos: abc
        type: u1
