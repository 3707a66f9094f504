# expect: 12:3: an enum without values
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
  color: {}
