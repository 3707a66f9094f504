meta:
  id: bad
  endian: be
types:
  contents_beside_type:
    -requirement: WIRE-DATA
    seq:
      # expect: 35: 'type' beside contents; contents stand alone
      - {id: a, contents: [0x7e], type: u1}
  contents_not_a_byte:
    -requirement: WIRE-DATA
    seq:
      # expect: 31: 256 in contents; a byte was expected
      - {id: a, contents: [1, 256]}
  contents_too_long:
    -requirement: WIRE-DATA
    seq:
      # expect: 27: contents of 3 bytes; 1, 2 or 4 bytes were expected; rubric --spec reads 3
      - {id: a, contents: [1, 2, 3]}
      # expect: 27: contents of 5 bytes; 1 to 4 bytes are read as one number
      - {id: b, contents: [1, 2, 3, 4, 5]}
  encoding_missing:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
      # expect: 23: text without encoding; known are ASCII, UTF-8, UTF-16LE, UTF-16BE,
      #   ISO-8859-1, windows-1252 and others that iconv -l names
      - {id: a, type: strz}
  encoding_unknown:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
      # expect: 39: the encoding 'KLINGON'; known are ASCII, UTF-8, UTF-16LE, UTF-16BE,
      #   ISO-8859-1, windows-1252 and others that iconv -l names
      - {id: a, type: strz, encoding: klingon}
  terminator_not_a_byte:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
      # expect: 38: 'terminator' is 256; a byte was expected
      - {id: a, size: 4, terminator: 256}
  terminator_of_a_number:
    -requirement: WIRE-DATA
    seq:
      # expect: 27: 'terminator' of a number or structure; text or bytes was expected
      - {id: a, type: u1, terminator: 0}
  text_of_wide_characters:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
      # expect: 57: 'terminator' of UTF-16LE; its characters have more than a byte; strz ends
      #   with one that is 0
      - {id: a, type: str, size: 8, encoding: utf-16le, terminator: 0}
  text_unread:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: text or a terminator in 'a'; bytes were expected; rubric --spec reads text
      - {id: a, type: strz, encoding: ASCII}
