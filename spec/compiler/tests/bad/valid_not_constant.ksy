# expect: 13:16: 'a' is not a constant; a number or an enum::value was expected
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
        valid: a
