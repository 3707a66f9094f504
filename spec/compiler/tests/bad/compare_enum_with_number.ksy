# expect: 15:15: 'n' and '1' cannot be compared; two numbers, or a field and a value of its enum;
#   .to_i makes a number
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
        type: u1
        if: n == 1
enums:
  color:
    1: red
    2: green
