# expect: 10:15: a byte order for one byte; u1 or s1 was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1le
