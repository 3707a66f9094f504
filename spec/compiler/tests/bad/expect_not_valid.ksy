# expect: 12:18: the expected value 4 is not valid; 'valid' refuses it
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {max: 3}
        -expect: 4
