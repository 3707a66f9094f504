# expect: 5:7: control character 0x01; a spec is plain UTF-8 text
meta:
  id: bad
  endian: be
doc: ab
