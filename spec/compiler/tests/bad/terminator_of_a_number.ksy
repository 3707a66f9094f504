# expect: 11:9: 'terminator' of a number or structure; text or bytes was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        terminator: 0
