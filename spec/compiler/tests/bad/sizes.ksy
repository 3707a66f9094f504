meta:
  id: bad
  endian: be
types:
  declared_size:
    -requirement: WIRE-DATA
    # expect: 12: -size 8 does not add up; the fields of 'declared_size' take 6 bytes
    -size: 8
    seq:
      - {id: a, type: u4}
      - {id: b, type: u2}
  declared_size_no_room:
    -requirement: WIRE-DATA
    # expect: 12: -size 4 leaves no room; 'declared_size_no_room' has at least 4 bytes and takes
    #   what follows
    -size: 4
    seq:
      - {id: a, type: u4}
      - {id: b, size-eos: true}
  size_always_zero:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 23: the size '0' is always 0; a field has bytes
      - {id: b, size: 0}
  size_and_size_eos:
    -requirement: WIRE-DATA
    seq:
      # expect: 26: size-eos beside size; one of both
      - {id: n, size: 1, size-eos: true}
  size_eos_not_last:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: field 'a' takes all bytes but is not the last; nothing can follow it
      - {id: a, size-eos: true}
      - {id: b, type: u1}
  size_missing:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: field 'n' has neither type nor size; type, size, size-eos or contents was
      #   expected
      - {id: n, doc: Bytes.}
  size_negative:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: the size '-1' is always negative; a field has bytes
      - {id: a, size: -1}
  size_of_a_condition:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 25: a size that is not a number: 'n == 1'; a number was expected; .to_i makes one
      #   of an enum
      - {id: b, size: n == 1}
  size_of_a_number:
    -requirement: WIRE-DATA
    seq:
      # expect: 33: a size for a number; its type says how large it is
      - {id: n, type: u1, size: 1}
  size_of_an_enum:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, enum: color}
      # expect: 23: a size that is not a number: 'n'; a number was expected; .to_i makes one of
      #   an enum
      - {id: b, size: n}
  size_too_small_for_type:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: 'a' never fits in 1 byte; it has at least 2
      - {id: a, size: 1, type: size_too_small_for_type_two}
  size_too_small_for_type_two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
  varying_structure_not_last:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: structure 'a' varies in size; only the last field can, or one with a size
      - {id: a, type: varying_structure_not_last_two}
      - {id: b, type: u1}
  varying_structure_not_last_two:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: b, size: n}
enums:
  color:
    1: red
    2: green
