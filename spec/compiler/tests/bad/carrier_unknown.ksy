# expect: 8:15: unknown carrier 'serail'; did you mean 'serial'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -carrier: serail
    seq:
      - id: a
        type: u1
