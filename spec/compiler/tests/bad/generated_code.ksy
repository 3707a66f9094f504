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
  # expect: 3: 'Bytes' hides a class of the runtime; another name was expected
  bytes:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: has_m, type: u1}
      # expect: 14: 'has_m' twice in the generated code of 'one'; line {-2} makes it too
      - {id: m, type: u1, if: n == 1}
  # expect: 3: 'OneView' twice in the generated code of 'bad'; line {-8} makes it too
  one_view:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
