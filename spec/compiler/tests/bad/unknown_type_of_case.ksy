# expect: 17:13: unknown type 'two'; known are one, u1, u2, u4, s1, s2, s4, f4, u2be, u2le, u4be,
#   u4le, ...
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
