# expect: 14:30: unexpected path; only '.to_i' can follow here
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
      - id: b
        type: u1
        if: a == color::red.x
enums:
  color:
    1: red
