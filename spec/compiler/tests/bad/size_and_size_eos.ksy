# expect: 11:9: size-eos beside size; one of both
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        size: 1
        size-eos: true
