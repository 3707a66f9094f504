# expect: 17:18: the expression ends early; a number, a field or an enum::value was expected
# expect: 19:21: a bracket is not closed; ')' was expected
# expect: 21:17: unexpected 'n'; an operator or the end of the expression was expected
# expect: 23:17: '&' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 25:15: '_parent' is outside the profile; fields of the same structure can be read
# expect: 27:16: the expression ends early; a number, a field or an enum::value was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: b
        size: n +
      - id: c
        size: (n + 1
      - id: d
        size: n n
      - id: e
        size: n & 3
      - id: f
        size: _parent.n
      - id: g
        size: ''
