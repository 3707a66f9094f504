# expect: 13:14: 'pos' is 'abc'; a decimal or 0x number was expected
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
