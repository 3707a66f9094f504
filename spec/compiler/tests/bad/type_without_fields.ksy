# expect: 6:3: type 'one' without fields; seq: with a field was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
