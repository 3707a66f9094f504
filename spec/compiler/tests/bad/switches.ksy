meta:
  id: bad
  endian: be
types:
  switch_case_is_a_list:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - id: a
        size: 4
        type:
          switch-on: n
          cases:
            1: two
            # expect: 16: the type of a case is a list; a value was expected
            2: [two]
  switch_impossible_case:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, valid: {max: 9}}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
            # expect: 13: case 10 can never be; the switch takes 0 to 9
            10: two
  switch_impossible_case_of_set:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, valid: {any-of: [1, 3]}}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
            # expect: 13: case 2 can never be; the switch takes 1 to 3
            2: two
            3: two
  switch_key_not_of_enum:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, enum: color}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            # expect: 13: '1' does not fit 'switch-on'; a value of color:: was expected
            1: two
  switch_missing_case:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1, enum: color, valid: {in-enum: true}}
      - id: b
        size-eos: true
        type:
          # expect: 22: missing cases: color::green; 'valid' allows them; '_' would take the rest
          switch-on: a
          cases:
            'color::red': two
  switch_on_comparison:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        size-eos: true
        type:
          # expect: 24: switch on a comparison; a number or enum was expected
          switch-on: a == 1
          cases:
            1: two
  switch_to_mask:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            # expect: 13: 'bits' is a mask; a case chooses a structure
            1: bits
  bits:
    -mask: 8
    seq:
      - {id: bit7, type: b1}
      - {id: bit6, type: b1}
      - {id: bit5, type: b1}
      - {id: bit4, type: b1}
      - {id: bit3, type: b1}
      - {id: bit2, type: b1}
      - {id: bit1, type: b1}
      - {id: bit0, type: b1}
  switch_without_cases:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        size-eos: true
        type:
          # expect: 11: a switch without cases; cases: was expected
          switch-on: a
  switch_without_size:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        type:
          # expect: 22: the switch of 'b' has no size; size or size-eos bounds the bytes of an
          #   unknown case
          switch-on: a
          cases:
            1: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
enums:
  color:
    1: red
    2: green
