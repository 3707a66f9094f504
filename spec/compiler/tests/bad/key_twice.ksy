# expect: 11:9: 'type' twice in a field; it is already in line 10
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        type: u2
