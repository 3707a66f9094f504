# expect: 15:15: 'm' may be absent; a field without 'if' was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: m
        type: u1
        if: n == 1
      - id: b
        size: m
