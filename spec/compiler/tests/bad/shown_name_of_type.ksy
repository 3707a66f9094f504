# expect: 8:12: name 'One'; lower snake case was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -name: One
    seq:
      - id: a
        type: u1
