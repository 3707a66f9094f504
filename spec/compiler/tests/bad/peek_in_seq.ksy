# expect: 12:15: instance 'b' cannot be read here; only instances read peeks
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: rest
        size: b
    instances:
      b:
        pos: 0
        type: u1
