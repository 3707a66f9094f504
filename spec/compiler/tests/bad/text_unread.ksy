# expect: 10:15: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: strz
        encoding: ASCII
