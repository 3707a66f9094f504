# expect: 11:36: 'a' repeats what takes no byte; an element of a byte or more was expected
# expect: 12:3: type 'two' without fields; seq: with a field was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      - {id: a, type: two, repeat: expr, repeat-expr: n}
  two:
    -requirement: WIRE-DATA
    seq: []
