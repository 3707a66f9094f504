# expect: 17:7: type 'one' has parameters; fields were expected, by which alone its size is known;
#   rubric --spec reads it
# expect: 19:26: a parameter of type 'str'; u1, u2, u4, s1, s2, s4, bool or b1 to b32 was expected
# expect: 21:23: 'length' has no fields to read; it is a parameter
# expect: 26:7: parameters of a message or frame, 'two'; nothing says what they are
# expect: 26:7: too many parameters: 9; at most 8 are read
# expect: 26:7: type 'two' has parameters; fields were expected, by which alone its size is known;
#   rubric --spec reads it
# expect: 27:9: unknown enum 'none'; there is none here
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    params:
      - {id: length, type: u1}
      - {id: many, type: bool}
      - {id: name, type: str}
    seq:
      - {id: a, size: length.more}
  two:
    -requirement: WIRE-DATA
    -am-type: 9
    params:
      - {id: p1, type: u1}
      - {id: p2, type: u1, enum: none}
      - {id: p3, type: u1}
      - {id: p4, type: u1}
      - {id: p5, type: u1}
      - {id: p6, type: u1}
      - {id: p7, type: u1}
      - {id: p8, type: u1}
      - {id: p9, type: u1}
    seq:
      - {id: a, type: u1}
