# expect: 11:15: unknown type 'onee'; did you mean 'one'?
# expect: 13:15: unknown type 'u8'; at most 4 bytes are read as a number; 'size: 8' keeps them
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: onee
      - id: b
        type: u8
