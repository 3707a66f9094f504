# expect: 14:15: the fields of 'a' cannot be read; a size delimits it; a structure without one was
#   expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: two
        size: 4
      - id: b
        size: a.n
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
