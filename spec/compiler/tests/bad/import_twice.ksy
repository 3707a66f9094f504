# expect: 7:7: 'imports/good' is imported twice
meta:
  id: bad
  endian: be
  imports:
    - imports/good
    - imports/good
