# expect: 14:8: an enum value without id; id: was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
enums:
  color:
    1: red
    2: {doc: Green.}
