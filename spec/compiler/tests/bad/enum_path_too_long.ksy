# expect: 13:18: too many '::'; enum::value or spec::enum::value
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        type: u1
        if: a == x::y::color::red.to_i
