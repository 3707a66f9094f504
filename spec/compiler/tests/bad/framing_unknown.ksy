# expect: 8:15: unknown framing 'slip'; known is hdlc
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -framing: slip
    seq:
      - id: a
        type: u1
