# expect: 13:18: 2147483648 is beyond 32 bits; constants of expressions are signed 32-bit numbers
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u4
      - id: b
        type: u1
        if: n == 0x80000000
