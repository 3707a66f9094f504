# expect: 10:13: 'size_bytes' hides a member of the generated view; another name was expected;
#   -name can show this one
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - id: size_bytes
        type: u1
