# expect: 18:13: case 10 can never be; the switch takes 0 to 9
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {max: 9}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
            10: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
