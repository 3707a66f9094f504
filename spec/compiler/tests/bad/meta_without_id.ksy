# expect: 2:1: meta without id; id: was expected
meta:
  endian: be
