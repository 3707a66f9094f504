# expect: 9:13: field 'n' has neither type nor size; type, size, size-eos or contents was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        doc: Bytes.
