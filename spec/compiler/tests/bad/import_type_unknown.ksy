# expect: 11:23: unknown type 'good::too'; did you mean 'two'?
meta:
  id: bad
  endian: be
  imports:
    - imports/good
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: good::too}
