# expect: 13:15: a size that is not a number: 'n'; a number was expected; .to_i makes one of an enum
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
        size: n
enums:
  color:
    1: red
    2: green
