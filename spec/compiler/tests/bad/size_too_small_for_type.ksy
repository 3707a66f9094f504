# expect: 10:15: 'a' never fits in 1 byte; it has at least 2
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 1
        type: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
