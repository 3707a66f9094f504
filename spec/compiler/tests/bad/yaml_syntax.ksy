# expect: 7:1: not YAML: end of sequence flow not found
meta:
  id: bad
  endian: be
types:
  one: [
