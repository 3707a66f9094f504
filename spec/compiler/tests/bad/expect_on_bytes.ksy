# expect: 11:18: -expect on 'a'; a single unsigned number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 2
        -expect: 4
