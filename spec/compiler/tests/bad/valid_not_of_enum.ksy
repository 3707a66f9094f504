# expect: 15:16: '1' does not fit 'a'; a value of color:: was expected
# expect: 18:16: 'color::red' does not fit 'b'; a number was expected
# expect: 21:16: in-enum without an enum; enum: was expected at the field
# expect: 25:22: the maximum of an enum; any-of or in-enum was expected
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
        valid: 1
      - id: b
        type: u1
        valid: color::red
      - id: c
        type: u1
        valid: {in-enum: true}
      - id: d
        type: u1
        enum: color
        valid: {max: 2}
enums:
  color:
    1: red
    2: green
