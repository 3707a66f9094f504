# expect: 11:16: a unit without symbol; symbol: was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u2
        -unit: {scale: 0.5}
