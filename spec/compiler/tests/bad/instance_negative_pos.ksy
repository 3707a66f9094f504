# expect: 13:14: pos -1; 0 to 65535 was expected
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
        pos: -1
        type: u1
