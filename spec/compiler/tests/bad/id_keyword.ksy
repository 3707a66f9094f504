# expect: 9:13: 'class' cannot be the name of a field; it is a word of C++ or of the profile
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: class
        type: u1
