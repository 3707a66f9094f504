# expect: 10:3: 'OneView' twice in the generated code of 'bad'; line 6 makes it too
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
  one_view:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
