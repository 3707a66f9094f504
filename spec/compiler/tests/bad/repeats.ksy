meta:
  id: bad
  endian: be
types:
  count_negative:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 57: the count '10 - n' can be negative; it is -245 to 10; 'valid' can narrow what
      #   it is made of
      - {id: b, type: u2, repeat: expr, repeat-expr: 10 - n}
  count_of_a_condition:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 56: a count that is not a number: 'n < 4'; a number was expected; .to_i makes one
      #   of an enum
      - {id: b, type: u1, repeat: expr, repeat-expr: n < 4}
  repeat_eos_not_last:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: field 'a' takes all bytes but is not the last; nothing can follow it
      - {id: a, type: u1, repeat: eos}
      - {id: b, type: u1}
  repeat_expr_alone:
    -requirement: WIRE-DATA
    seq:
      # expect: 27: repeat-expr without repeat: expr
      - {id: a, type: u1, repeat-expr: 4}
  repeat_of_bytes:
    -requirement: WIRE-DATA
    seq:
      # expect: 34: repeat of bytes; numbers, masks or structures can repeat: put it into a type
      #   of its own
      - {id: a, size: 4, repeat: eos}
  repeat_of_varying:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: structure 'a' varies in size; only the last field can, or one with a size
      - {id: a, type: repeat_of_varying_two, repeat: eos}
  repeat_of_varying_two:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: b, size: n}
  repeat_until:
    -requirement: WIRE-DATA
    seq:
      # expect: 35: repeat: until without a condition; repeat-until: was expected
      # expect: 35: repeat: until; a count was expected, so that the size is known before; rubric
      #   --spec reads it
      - {id: a, type: u1, repeat: until}
  repeat_until_misuse:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 35: repeat: until; a count was expected, so that the size is known before; rubric
      #   --spec reads it
      # expect: 58: 'repeat-until' is not a condition; a comparison was expected
      - {id: b, type: u1, repeat: until, repeat-until: _ + 1}
      # expect: 27: repeat-until without repeat: until
      - {id: c, type: u1, repeat-until: _ == 0}
      # expect: 35: repeat is 'often'; expr, eos or until was expected
      - {id: d, type: u1, repeat: often}
      # expect: 31: '_' is outside the profile; fields of the same structure can be read
      - {id: e, type: u1, if: _ == 0}
  repeat_until_of_another_field:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 35: repeat: until; a count was expected, so that the size is known before; rubric
      #   --spec reads it
      # expect: 61: 'n' is outside the profile; the element, '_', and parameters can be read here
      - {id: a, type: u1, repeat: until, repeat-until: _ == n}
  repeat_without_expr:
    -requirement: WIRE-DATA
    seq:
      # expect: 35: repeat: expr without a count; repeat-expr: was expected
      - {id: a, type: u1, repeat: expr}
  repeat_of_nothing:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      # expect: 36: 'a' repeats what takes no byte; an element of a byte or more was expected
      - {id: a, type: two, repeat: expr, repeat-expr: n}
  # expect: 3: type 'two' without fields; seq: with a field was expected
  two:
    -requirement: WIRE-DATA
    seq: []
