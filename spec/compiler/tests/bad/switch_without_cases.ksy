# expect: 14:11: a switch without cases; cases: was expected
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
