# expect: 11:3: 'one' twice in types; it is already in line 6
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
  one:
    seq: []
