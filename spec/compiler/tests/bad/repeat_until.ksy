# expect: 13:17: repeat: until without a condition; repeat-until: was expected
# expect: 13:17: repeat: until; a count was expected, so that the size is known before; rubric
#   --spec reads it
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        repeat: until
