# expect: 11:23: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
# expect: 11:57: 'terminator' of UTF-16LE; its characters have more than a byte; strz ends with
#   one that is 0
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: str, size: 8, encoding: utf-16le, terminator: 0}
