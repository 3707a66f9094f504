# expect: 17:16: the type of a case is a list; a value was expected
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
            2: [two]
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u1}
