meta:
  id: bad
  endian: be
types:
  remainder_by_zero:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, valid: {max: 4}}
      # expect: 27: 'n - 2' can be zero; a divisor that is never zero was expected
      - {id: b, size: 100 % (n - 2)}
  to_i_misuse:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, enum: color}
      - id: b
        type: u1
        # expect: 30: unexpected path; only '.to_i' can follow here
        if: a == color::red.x
  unknown_field:
    -requirement: WIRE-DATA
    seq:
      - {id: length, type: u1}
      # expect: 23: unknown field 'lenght'; did you mean 'length'?
      - {id: b, size: lenght}
enums:
  color:
    1: red
