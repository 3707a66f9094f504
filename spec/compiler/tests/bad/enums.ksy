meta:
  id: bad
  endian: be
types:
  add_an_enum:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, enum: color}
      # expect: 23: 'n' does not fit here; a number was expected; .to_i makes one of an enum
      - {id: b, size: n + 1}
  compare_enum_with_number:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, enum: color}
      # expect: 33: 'n' and '1' cannot be compared; two numbers, or a field and a value of its
      #   enum; .to_i makes a number
      - {id: b, type: u1, if: n == 1}
  enum_on_float:
    -requirement: WIRE-DATA
    seq:
      # expect: 33: an enum on 'a'; an unsigned number was expected
      - {id: a, type: f4, enum: color}
  enum_path_too_long:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        type: u1
        # expect: 18: too many '::'; enum::value or spec::enum::value
        if: a == x::y::color::red.to_i
  unknown_enum:
    -requirement: WIRE-DATA
    seq:
      # expect: 33: unknown enum 'colour'; did you mean 'color'?
      - {id: a, type: u1, enum: colour}
  unknown_enum_in_expression:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, enum: color}
      - id: b
        type: u1
        # expect: 18: unknown enum in 'colour::red'; did you mean 'color'?
        if: a == colour::red
  unknown_enum_value:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: color
        # expect: 16: unknown enum value 'color::gren'; did you mean 'green'?
        valid: color::gren
enums:
  color:
    1: red
    2: green
