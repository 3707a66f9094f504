# expect: 11:19: contents of 3 bytes; 1, 2 or 4 bytes were expected; rubric --spec reads 3
# expect: 13:19: contents of 5 bytes; 1 to 4 bytes are read as one number
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        contents: [1, 2, 3]
      - id: b
        contents: [1, 2, 3, 4, 5]
