# expect: 10:19: contents of 3 bytes; 1, 2 or 4 bytes are read as one number
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        contents: [1, 2, 3]
