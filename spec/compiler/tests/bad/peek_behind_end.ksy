# expect: 12:7: peek 'b' lies after the end of 'one'; 'one' has at most 1 byte
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
    instances:
      b:
        pos: 1
        type: u1
