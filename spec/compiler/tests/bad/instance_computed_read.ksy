# expect: 19:15: instance 'c' cannot be read here; it has no value that is always there
# expect: 25:7: instance 'b' is computed; a number or a type at pos was expected
# expect: 26:7: instance 'c' is computed; a number or a type at pos was expected
# expect: 27:7: instance 'd' is computed; a number or a type at pos was expected
# expect: 27:18: instance 'd' takes too many others; or is computed from itself
# expect: 28:7: instance 'e' is computed; a number or a type at pos was expected
# expect: 28:18: unknown enum 'nowhere'; there is none here
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
      - id: more
        size: c
      - id: ring
        size: d
      - id: rest
        size: e
    instances:
      b: {value: a * 2}
      c: {value: a, if: a > 2}
      d: {value: d + 1}
      e: {value: a, enum: nowhere}
