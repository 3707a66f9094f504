# expect: 16:13: type 'one' contains itself; types must not form a circle
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: one
