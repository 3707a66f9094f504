# expect: 14:7: instance 'b' is computed; a number or a type at pos was expected
# expect: 16:7: instance 'c' is computed; a number or a type at pos was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
    instances:
      # Where nothing else reads them, rubric --spec passes them over.
      b:
        value: a + 1
      c:
        pos: a
        type: u1
