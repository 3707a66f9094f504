# expect: 14:18: unknown enum in 'colour::red'; did you mean 'color'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: color
      - id: b
        type: u1
        if: a == colour::red
enums:
  color:
    1: red
    2: green
