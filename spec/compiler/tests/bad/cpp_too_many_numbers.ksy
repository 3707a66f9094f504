# expect: 6:3: 't0' nests too many numbers; at most 4096 are laid out
meta:
  id: bad
  endian: be
types:
  t0:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t1}
      - {id: b, type: t1}
  t1:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t2}
      - {id: b, type: t2}
  t2:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t3}
      - {id: b, type: t3}
  t3:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t4}
      - {id: b, type: t4}
  t4:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t5}
      - {id: b, type: t5}
  t5:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t6}
      - {id: b, type: t6}
  t6:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t7}
      - {id: b, type: t7}
  t7:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t8}
      - {id: b, type: t8}
  t8:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t9}
      - {id: b, type: t9}
  t9:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t10}
      - {id: b, type: t10}
  t10:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t11}
      - {id: b, type: t11}
  t11:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: t12}
      - {id: b, type: t12}
  t12:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: b, type: u1}
