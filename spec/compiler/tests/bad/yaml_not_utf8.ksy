# expect: 5:10: byte 0xe4 is not UTF-8; a spec is plain UTF-8 text
meta:
  id: bad
  endian: be
doc: n√§h‰ am
