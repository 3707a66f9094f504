# expect: 14:15: duplicate carrier 'serial'; line 8 has it already
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -carrier: serial
    seq:
      - id: a
        type: u1
  two:
    -requirement: WIRE-DATA
    -carrier: serial
    seq:
      - {id: b, type: u2}
