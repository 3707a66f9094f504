# expect: 10:19: 'size-eos' is 'yes'; true or false was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a
        size-eos: yes
