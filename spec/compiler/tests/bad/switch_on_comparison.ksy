# expect: 14:24: switch on a comparison; a number or enum was expected
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
          switch-on: a == 1
          cases:
            1: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
