# expect: 17:13: '1' does not fit 'switch-on'; a value of color:: was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: color
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
enums:
  color:
    1: red
    2: green
