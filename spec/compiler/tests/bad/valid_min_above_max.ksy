# expect: 11:16: the minimum 4 is above the maximum 3; no value would be valid
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {min: 4, max: 3}
