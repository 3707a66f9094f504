# expect: 11:16: name 'Shown'; lower snake case was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        -name: Shown
