# expect: 8:12: -size 8 does not add up; the fields of 'one' take 6 bytes
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -size: 8
    seq:
      - id: a
        type: u4
      - id: b
        type: u2
