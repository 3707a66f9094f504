# expect: 15:5: duplicate enum value 2; line 14 names it already
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
    0x02: blue
