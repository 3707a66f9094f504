# expect: imports/circle_back.ksy:5:7: 'circle' imports itself in a circle; imports must end
meta:
  id: bad
  endian: be
  imports:
    - imports/circle
