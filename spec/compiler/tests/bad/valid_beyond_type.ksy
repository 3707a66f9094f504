# expect: 14:22: the maximum 256 is beyond 'a'; 0 to 255 was expected
# expect: 17:22: the minimum -129 is beyond 'b'; -128 to 127 was expected
# expect: 20:29: the valid value 256 is beyond 'c'; 0 to 255 was expected
# expect: 23:16: the valid value 300 is beyond 'd'; 0 to 255 was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {max: 256}
      - id: b
        type: s1
        valid: {min: -129}
      - id: c
        type: u1
        valid: {any-of: [1, 0x100]}
      - id: d
        type: u1
        valid: 300
