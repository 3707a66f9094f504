meta: {id: choices, endian: be}
enums:
  kind:
    1: {id: small, doc: One byte.}
    2: large
types:
  small:
    -requirement: WIRE-DATA
    -am-type: 9
    seq:
      - {id: x, type: u1}
  large:
    -requirement: WIRE-DATA
    seq:
      - {id: y, type: u4}
      - {id: flags, type: bits}
  bits:
    -mask: 8
    seq:
      - {id: b7, type: b1, -unnamed: true}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      - {id: b0, type: b1}
  outer:
    -requirement: WIRE-DATA
    seq:
      - {id: kind, type: u1, enum: kind, valid: {in-enum: true}}
      - {id: size_of_it, type: u1, valid: {max: 20}}
      - id: extra
        type: u1
        if: kind == kind::large and size_of_it > 2
      - id: it
        size: size_of_it
        type:
          switch-on: kind
          cases:
            kind::small: small
            kind::large: large
