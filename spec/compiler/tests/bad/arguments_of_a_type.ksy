# expect: 11:15: arguments for type 'two': 1; as many as its parameters were expected: 0
# expect: 13:15: unknown type 'f8'; a float has 4 bytes; 'size: 8' keeps them
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: two(1)
      - id: b
        type: f8
  two:
    -requirement: WIRE-DATA
    seq:
      - id: c
        type: u1
