# expect: 11:17: repeat of bytes; numbers, masks or structures can repeat: put it into a type of its own
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 4
        repeat: eos
