# expect: 15:5: enum value 'blue'; a number of 0 to 0xffffffff was expected
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
    2: green
    blue: 3
