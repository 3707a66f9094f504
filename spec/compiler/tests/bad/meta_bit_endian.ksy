# expect: 5:15: bit-endian is 'middle'; be or le was expected
meta:
  id: bad
  endian: be
  bit-endian: middle
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
