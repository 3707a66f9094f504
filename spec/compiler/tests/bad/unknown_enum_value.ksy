# expect: 12:16: unknown enum value 'color::gren'; did you mean 'green'?
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
        valid: color::gren
enums:
  color:
    1: red
    2: green
