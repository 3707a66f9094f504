# expect: 15:5: duplicate enum value 'red'; it is already in line 13
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
    3: red
