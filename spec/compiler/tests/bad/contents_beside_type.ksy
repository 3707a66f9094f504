# expect: 11:9: 'type' beside contents; contents stand alone
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        contents: [0x7e]
        type: u1
