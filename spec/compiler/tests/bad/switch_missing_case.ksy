# expect: 16:22: missing cases: color::green; 'valid' allows them; '_' would take the rest
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: color
        valid: {in-enum: true}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            'color::red': two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
enums:
  color:
    1: red
    2: green
