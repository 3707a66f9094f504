# expect: 15:35: repeat: until; a count was expected, so that the size is known before; rubric
#   --spec reads it
# expect: 15:58: 'repeat-until' is not a condition; a comparison was expected
# expect: 16:27: repeat-until without repeat: until
# expect: 17:35: repeat is 'often'; expr, eos or until was expected
# expect: 18:31: '_' is outside the profile; fields of the same structure can be read
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: b, type: u1, repeat: until, repeat-until: _ + 1}
      - {id: c, type: u1, repeat-until: _ == 0}
      - {id: d, type: u1, repeat: often}
      - {id: e, type: u1, if: _ == 0}
