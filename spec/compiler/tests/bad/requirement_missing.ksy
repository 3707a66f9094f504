# expect: 6:3: type 'one' without requirement; -requirement: was expected
meta:
  id: bad
  endian: be
types:
  one:
    seq:
      - {id: a, type: u1}
