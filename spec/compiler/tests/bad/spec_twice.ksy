# expect: 3:7: a second spec 'bad'; 'spec/compiler/tests/bad/imports/same_id.ksy' has that id
meta:
  id: bad
  endian: be
  imports:
    - imports/same_id
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
