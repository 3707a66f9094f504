# expect: 9:13: field 'a' takes all bytes but is not the last; nothing can follow it
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        repeat: eos
      - id: b
        type: u1
