# expect: 16:15: 'm' is at no constant position; what comes before it must have a constant size
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: a
        size: n
      - id: m
        type: u1
      - id: b
        size: m
