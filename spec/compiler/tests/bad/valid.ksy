meta:
  id: bad
  endian: be
types:
  expect_beyond_type:
    -requirement: WIRE-DATA
    seq:
      # expect: 36: the expected value 256 is beyond 'a'; 0 to 255 was expected
      - {id: a, type: u1, -expect: 256}
  expect_not_valid:
    -requirement: WIRE-DATA
    seq:
      # expect: 53: the expected value 4 is not valid; 'valid' refuses it
      - {id: a, type: u1, valid: {max: 3}, -expect: 4}
  expect_on_bytes:
    -requirement: WIRE-DATA
    seq:
      # expect: 35: -expect on 'a'; a single unsigned number was expected
      - {id: a, size: 2, -expect: 4}
  valid_any_of_nothing:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        valid:
          # expect: 19: no value is valid
          any-of: []
  valid_beyond_type:
    -requirement: WIRE-DATA
    seq:
      # expect: 40: the maximum 256 is beyond 'a'; 0 to 255 was expected
      - {id: a, type: u1, valid: {max: 256}}
      # expect: 40: the minimum -129 is beyond 'b'; -128 to 127 was expected
      - {id: b, type: s1, valid: {min: -129}}
      # expect: 47: the valid value 256 is beyond 'c'; 0 to 255 was expected
      - {id: c, type: u1, valid: {any-of: [1, 0x100]}}
      # expect: 34: the valid value 300 is beyond 'd'; 0 to 255 was expected
      - {id: d, type: u1, valid: 300}
  valid_min_above_max:
    -requirement: WIRE-DATA
    seq:
      # expect: 34: the minimum 4 is above the maximum 3; no value would be valid
      - {id: a, type: u1, valid: {min: 4, max: 3}}
  valid_mixed:
    -requirement: WIRE-DATA
    seq:
      # expect: 34: valid mixes rules or has none; one of eq, any-of, in-enum, or min and max was
      #   expected
      - {id: a, type: u1, valid: {eq: 3, max: 4}}
      # expect: 34: valid mixes rules or has none; one of eq, any-of, in-enum, or min and max was
      #   expected
      - {id: b, type: u1, valid: {}}
  valid_not_constant:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 34: 'a' is not a constant; a number or an enum::value was expected
      - {id: b, type: u1, valid: a}
  valid_not_of_enum:
    -requirement: WIRE-DATA
    seq:
      # expect: 47: '1' does not fit 'a'; a value of color:: was expected
      - {id: a, type: u1, enum: color, valid: 1}
      - id: b
        type: u1
        # expect: 16: 'color::red' does not fit 'b'; a number was expected
        valid: color::red
      # expect: 34: in-enum without an enum; enum: was expected at the field
      - {id: c, type: u1, valid: {in-enum: true}}
      # expect: 53: the maximum of an enum; any-of or in-enum was expected
      - {id: d, type: u1, enum: color, valid: {max: 2}}
  valid_on_bytes:
    -requirement: WIRE-DATA
    seq:
      # expect: 33: valid on 'a'; an integer was expected
      - {id: a, size: 4, valid: 3}
      # expect: 34: valid on 'b'; an integer was expected
      - {id: b, type: f4, valid: {min: 0}}
enums:
  color:
    1: red
    2: green
