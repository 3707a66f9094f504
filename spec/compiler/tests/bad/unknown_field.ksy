# expect: 12:15: unknown field 'lenght'; did you mean 'length'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: length
        type: u1
      - id: b
        size: lenght
