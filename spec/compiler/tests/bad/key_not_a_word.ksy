# expect: 11:9: a key of a field is a list; a plain word was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        [b, c]: d
