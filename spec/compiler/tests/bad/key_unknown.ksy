# expect: 10:9: unknown key 'typ' of a field; did you mean 'type'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        typ: u1
