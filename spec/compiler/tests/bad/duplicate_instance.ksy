# expect: 12:7: duplicate field 'a'; it is already in line 9
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
      a:
        pos: 0
        type: u1
