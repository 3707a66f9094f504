# expect: 7:5: unknown key '-requirment' of a type; did you mean '-requirement'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirment: WIRE-DATA
    seq:
      - {id: a, type: u1}
