# expect: 12:7: an instance without pos
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
        type: u1
