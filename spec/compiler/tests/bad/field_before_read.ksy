# expect: 10:15: field 'length' is used before it is read; only fields further up are known here
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: b
        size: length
      - id: length
        type: u1
