# expect: 14:23: type 'one' contains itself; types must not form a circle
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: one}
