# expect: 13:15: 'n' does not fit here; a number was expected; .to_i makes one of an enum
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
        enum: color
      - id: b
        size: n + 1
enums:
  color:
    1: red
    2: green
