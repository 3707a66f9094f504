# expect: 11:15: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
# expect: 11:15: text without encoding; known are ASCII and UTF-8
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: strz
