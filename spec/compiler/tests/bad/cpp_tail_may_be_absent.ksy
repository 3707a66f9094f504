# expect: 14:15: field 'a' takes all bytes and may be absent; a field with 'if' must have a size of
#   its own
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: a
        size-eos: true
        if: n == 1
