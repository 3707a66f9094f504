# expect: 10:23: 256 in contents; a byte was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        contents: [1, 256]
