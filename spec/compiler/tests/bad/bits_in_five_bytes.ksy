# expect: 13:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
# expect: 14:13: the bits 'b' lie in five bytes; at most four are read as one number
# expect: 15:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
# expect: 17:15: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric --spec reads bits
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: b4
      - id: b
        type: b32
      - id: c
        type: b4
