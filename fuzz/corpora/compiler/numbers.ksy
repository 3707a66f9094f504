meta:
  id: numbers
  endian: le
types:
  one:
    doc: Every number.
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, valid: {min: 1, max: 0x1f}}
      - {id: b, type: s1}
      - {id: c, type: u2be, valid: 7}
      - {id: d, type: s2, -unit: {symbol: degC, scale: 0.01, offset: -39.6}}
      - {id: e, type: u4, valid: {any-of: [1, 2, 0xffffffff]}}
      - {id: f, type: f4be}
      - {id: g, type: u1, -expect: 3}
      - id: h
        contents: [0x7e, 1]
