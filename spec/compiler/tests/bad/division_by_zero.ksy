# expect: 12:19: 'n' can be zero; a divisor that is never zero was expected
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
        size: 100 / n
