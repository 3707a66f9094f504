# expect: 17:13: duplicate case 1; line 16 has it already
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
          switch-on: a
          cases:
            1: two
            0x01: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
