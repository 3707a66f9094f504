# expect: 11:15: unknown enum 'colour'; did you mean 'color'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: colour
enums:
  color:
    1: red
    2: green
