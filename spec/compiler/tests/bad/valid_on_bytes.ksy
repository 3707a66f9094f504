# expect: 12:16: valid on 'a'; an integer was expected
# expect: 15:16: valid on 'b'; an integer was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 4
        valid: 3
      - id: b
        type: f4
        valid: {min: 0}
