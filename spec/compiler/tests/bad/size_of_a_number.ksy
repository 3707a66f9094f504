# expect: 11:15: a size for a number; its type says how large it is
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
        size: 1
