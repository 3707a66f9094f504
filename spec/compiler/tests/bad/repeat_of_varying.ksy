# expect: 9:13: structure 'a' varies in size; only the last field can, or one with a size
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: two
        repeat: eos
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: b, size: n}
