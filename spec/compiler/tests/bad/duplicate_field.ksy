# expect: 11:13: duplicate field 'a'; it is already in line 9
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: a
        type: u1
