# expect: 12:15: 'n' cannot be read in an expression; an unsigned number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: s1
      - id: b
        size: n
