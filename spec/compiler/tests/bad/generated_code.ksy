meta:
  id: bad
  endian: be
types:
  cpp_array_too_long:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u2}
      # expect: 14: 'a' has up to 131070 elements; the generated code takes at most 65535
      - {id: a, type: u2, repeat: expr, repeat-expr: n * 2}
  cpp_member:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: 'size_bytes' hides a member of the generated view; another name was expected;
      #   -name can show this one
      - {id: size_bytes, type: u1}
  cpp_tail_may_be_absent:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 39: field 'a' takes all bytes and may be absent; a field with 'if' must have a
      #   size of its own
      - {id: a, size-eos: true, if: n == 1}
