# expect: 9:19: AM type 256; 0 to 255 was expected
# expect: 9:24: AM type 1 twice; each once
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -am-type: [1, 256, 1]
    seq:
      - id: a
        type: u1
