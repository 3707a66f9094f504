# expect: 8:12: -size 4 leaves no room; 'one' has at least 4 bytes and takes what follows
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -size: 4
    seq:
      - id: a
        type: u4
      - id: b
        size-eos: true
