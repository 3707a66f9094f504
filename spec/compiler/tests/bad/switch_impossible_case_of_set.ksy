# expect: 18:13: case 2 can never be; the switch takes 1 to 3
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid: {any-of: [1, 3]}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
            2: two
            3: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
