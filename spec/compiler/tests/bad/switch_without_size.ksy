# expect: 14:22: the switch of 'b' has no size; size or size-eos bounds the bytes of an unknown
#   case
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
        type:
          switch-on: a
          cases:
            1: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
