# expect: 11:17: repeat is 'until'; expr or eos was expected
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
