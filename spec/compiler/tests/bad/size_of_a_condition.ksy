# expect: 13:17: a size that is not a number: 'n == 1'; a number was expected; .to_i makes one of an
#   enum
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: b
        size: n == 1
