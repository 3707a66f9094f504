# expect: 11:14: 'doc' is a list; a value was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        doc: [a, b]
