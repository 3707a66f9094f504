meta: {id: arrays, endian: be}
types:
  item:
    -requirement: WIRE-DATA
    seq:
      - {id: x, type: u2}
  counted:
    -requirement: WIRE-DATA
    -size: 41
    seq:
      - {id: n, type: u1, valid: {max: 10}}
      - {id: items, type: item, repeat: expr, repeat-expr: n}
      - {id: rest, type: f4le, repeat: eos}
  sized:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, valid: {max: 8}}
      - {id: m, type: u1, valid: {max: 8}}
      - {id: all, size: n * m + 1}
