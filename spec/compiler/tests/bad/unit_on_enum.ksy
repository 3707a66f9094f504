# expect: 12:16: -unit on 'a'; a plain number was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        enum: color
        -unit: {symbol: ms}
enums:
  color:
    1: red
    2: green
