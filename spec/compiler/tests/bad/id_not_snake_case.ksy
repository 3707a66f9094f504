# expect: 9:13: name 'seqNum'; lower snake case was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: seqNum
        type: u1
