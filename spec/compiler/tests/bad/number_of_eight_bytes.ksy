# expect: 13:15: a number of 8 bytes in 'size'; 1, 2 or 4 bytes were expected; rubric --spec reads 8
# expect: 15:15: 'size' has 64 bits; expressions read numbers of at most 32
# expect: 17:15: a number of 8 bytes in 'few'; 1, 2 or 4 bytes were expected; rubric --spec reads 8
# expect: 19:16: the maximum 9007199254740992 is beyond 'few'; 0 to 9007199254740991 was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: size
        type: u8
      - id: body
        size: size
      - id: few
        type: u8le
        valid:
          max: 0x20000000000000
