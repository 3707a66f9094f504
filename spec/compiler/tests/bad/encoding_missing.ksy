# expect: 12:15: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
# expect: 12:15: text without encoding; known are ASCII, UTF-8, UTF-16LE, UTF-16BE, ISO-8859-1,
#   windows-1252 and others that iconv -l names
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: strz
