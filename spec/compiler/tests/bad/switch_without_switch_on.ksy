# expect: 12:11: a type without switch-on; a type, or switch-on and cases was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 4
        type:
          cases:
            1: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u1}
