# expect: 6:7: import 'nowhere' not found; 'spec/compiler/tests/bad/nowhere.ksy' was expected
meta:
  id: bad
  endian: be
  imports:
    - nowhere
