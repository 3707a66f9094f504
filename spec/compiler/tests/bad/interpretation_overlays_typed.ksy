# expect: 16:7: interpretation 'body' overlays nothing; a size-eos field without type at offset 1
#   was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: rest
        size-eos: true
        type: two
    instances:
      body:
        pos: 1
        size-eos: true
        type: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
