# expect: 8:19: unknown requirement 'WIRE-DAT'; did you mean 'WIRE-DATA'?
# expect: 12:23: unknown requirement 'WIRE-DATUM'; did you mean 'WIRE-DATA'?
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DAT
    seq:
      - id: a
        type: u1
        -requirement: WIRE-DATUM
