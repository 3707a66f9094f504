# expect: 11:15: an enum on 'a'; an unsigned number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: f4
        enum: color
enums:
  color:
    1: red
    2: green
