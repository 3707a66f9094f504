# expect: 8:12: '-size' is 'one'; a decimal or 0x number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -size: one
    seq:
      - id: a
        type: u1
