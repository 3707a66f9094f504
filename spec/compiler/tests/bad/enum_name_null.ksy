# expect: 15:8: an enum value is nothing; a value was expected; quote the word 'null'
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
    3: null
