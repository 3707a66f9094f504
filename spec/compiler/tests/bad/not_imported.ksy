# expect: 10:15: 'other' is not imported; there is none here
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: other::two
