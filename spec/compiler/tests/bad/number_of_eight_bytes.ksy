# expect: 16:15: a number of 8 bytes in 'size'; 1, 2 or 4 bytes were expected; rubric --spec reads 8
# expect: 18:15: 'size' has 64 bits; expressions read numbers of at most 32
# expect: 20:15: a number of 8 bytes in 'few'; 1, 2 or 4 bytes were expected; rubric --spec reads 8
# expect: 22:16: the maximum 9007199254740992 is beyond 'few'; 0 to 9007199254740991 was expected
# expect: 24:15: a number of 8 bytes in 'most'; 1, 2 or 4 bytes were expected; rubric --spec reads 8
# expect: 26:16: '0xfffffffffffffffe' is too large; at most 9007199254740991 was expected, which rules of
#   a u8 can name
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
      - id: most
        type: u8
        valid:
          max: 0xfffffffffffffffe
