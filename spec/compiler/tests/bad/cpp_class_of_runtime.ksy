# expect: 6:3: 'Bytes' hides a class of the runtime; another name was expected
meta:
  id: bad
  endian: be
types:
  bytes:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
