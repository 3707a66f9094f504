# expect: 14:16: valid mixes rules or has none; one of eq, any-of, in-enum, or min and max was
#   expected
# expect: 17:16: valid mixes rules or has none; one of eq, any-of, in-enum, or min and max was
#   expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {eq: 3, max: 4}
      - id: b
        type: u1
        valid: {}
