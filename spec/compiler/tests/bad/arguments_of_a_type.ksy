# expect: 11:15: unknown type 'two(1)'; arguments of types are not read
# expect: 13:15: unknown type 'u8'; at most 4 bytes are read as a number; 'size: 8' keeps them
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
        type: u8
  two:
    -requirement: WIRE-DATA
    seq:
      - id: c
        type: u1
