# expect: 12:5: types within a type; beside the others was expected
# expect: 17:5: enums within a type; beside the others was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: inner
    types:
      inner:
        -requirement: WIRE-DATA
        seq:
          - {id: b, type: u1, enum: color}
    enums:
      color:
        1: red
