# expect: 12:17: a name is missing; a word was expected after '.' or '::'
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        size: a.
