# expect: 10:13: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
# expect: 12:21: 'terminator' is 256; a byte was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size: 4
        terminator: 256
