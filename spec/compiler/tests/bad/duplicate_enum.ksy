# expect: 15:3: 'color' twice in enums; it is already in line 12
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
  color:
    3: blue
