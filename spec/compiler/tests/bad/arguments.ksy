# expect: 17:7: type 'one' has parameters; fields were expected, by which alone its size is known;
#   rubric --spec reads it
# expect: 25:28: 'a' can be beyond 'length'; 0 to 255 was expected
# expect: 26:31: '1' does not fit 'more'; an argument of the parameter's type was expected
# expect: 27:28: '300' never fits 'length'; 0 to 255 was expected
# expect: 28:23: arguments for type 'one': 0; as many as its parameters were expected: 2
# expect: 29:23: a bracket is not closed; ')' was expected at the end
# expect: 29:23: arguments for type 'one': 0; as many as its parameters were expected: 2
# expect: 36:13: arguments for type 'one': 1; as many as its parameters were expected: 2
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    params:
      - {id: length, type: u1}
      - {id: more, type: bool}
    seq:
      - {id: a, size: length}
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u2}
      - {id: b, type: 'one(a, true)', size: 3}
      - {id: c, type: 'one(1, 1)', size: 3}
      - {id: d, type: 'one(300, true)', size: 3}
      - {id: e, type: one, size: 3}
      - {id: f, type: 'one(1, true', size: 3}
      - id: g
        size-eos: true
        type:
          switch-on: a
          cases:
            1: one(1, true)
            _: one(1)
