# expect: 18:15: 'a' has no fields to read; its type depends on a switch
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: a
        size: 4
        type:
          switch-on: n
          cases:
            1: two
      - id: b
        size: a.c
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: c, type: u1}
