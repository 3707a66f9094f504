# A spec without mistakes, to import.
meta:
  id: good
  endian: be
types:
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u2}
