# expect: 13:19: 'n - 2' can be zero; a divisor that is never zero was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
        valid: {max: 4}
      - id: b
        size: 100 % (n - 2)
