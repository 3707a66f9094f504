# expect: 11:13: fields 'a_1' and 'a1' differ only in '_'; they become one name in C++
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: a_1
        type: u1
      - id: a1
        type: u1
