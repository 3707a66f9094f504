# expect: 2:1: what is here belongs to nothing; one document was expected
, of what was here before
meta:
  id: bad
  endian: be
seq: []
