# expect: 12:15: instance 'b' cannot be read here; it is computed, and passed over
# expect: 14:7: instance 'b' is computed; a number or a type at pos was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: body
        size: b
    instances:
      b: {value: a * 2}
