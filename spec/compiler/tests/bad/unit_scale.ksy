# expect: 11:36: 'scale' is 'ten'; a decimal number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        -unit: {symbol: ms, scale: ten}
