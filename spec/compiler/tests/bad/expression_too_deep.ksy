# expect: 13:52: the expression nests too deep; write it simpler
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: n
        type: u1
      - id: b
        size:
          ((((((((((((((((((((((((((((((((((((((((((((((((((n
          ))))))))))))))))))))))))))))))))))))))))))))))))))
