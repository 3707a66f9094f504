# expect: 11:15: unknown type 'onee'; did you mean 'one'?
# expect: 13:15: unknown type 'f8'; a float has 4 bytes; 'size: 8' keeps them
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
        type: f8
