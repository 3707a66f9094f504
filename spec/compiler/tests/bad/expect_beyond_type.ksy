# expect: 11:18: the expected value 256 is beyond 'a'; 0 to 255 was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        -expect: 256
