# expect: 12:35: repeat: until; a count was expected, so that the size is known before; rubric
#   --spec reads it
# expect: 12:61: 'n' is outside the profile; the element, '_', and parameters can be read here
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: a, type: u1, repeat: until, repeat-until: _ == n}
