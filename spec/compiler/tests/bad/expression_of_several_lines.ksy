# expect: 18:15: unknown field 'folded'; known are n
# expect: 22:13: unknown field 'plain'; known are n, a
# expect: 25:25: unknown field 'quoted'; known are n, a, b
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
        size: >
          n
            + (2
              * 1
            + folded)
      - id: b
        size:
          n +
            plain
      - id: c
        size: "n +
             (1 +  1) + quoted"
