# expect: 13:13: 'has_m' twice in the generated code of 'one'; line 11 makes it too
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: has_m
        type: u1
      - id: m
        type: u1
        if: n == 1
