# expect: 5:1: what is here belongs to nothing; one document was expected
meta:
  id: bad
  endian: be
---
types:
  one: {}
