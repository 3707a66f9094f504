meta:
  id: bad
  endian: be
types:
  field_before_read:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: field 'length' is used before it is read; only fields further up are known
      #   here
      - {id: b, size: length}
      - {id: length, type: u1}
  field_may_be_absent:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: m, type: u1, if: n == 1}
      # expect: 23: 'm' may be absent; a field without 'if' was expected
      - {id: b, size: m}
  field_of_a_number:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 23: 'n' has no fields to read; it is not a structure
      - {id: b, size: n.x}
  field_of_a_switch:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - id: a
        size: 4
        type:
          switch-on: n
          cases:
            1: field_of_a_switch_two
      # expect: 23: 'a' has no fields to read; its type depends on a switch
      - {id: b, size: a.c}
  field_of_a_switch_two:
    -requirement: WIRE-DATA
    seq:
      - {id: c, type: u1}
  field_signed_in_expression:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: s1}
      # expect: 23: 'n' cannot be read in an expression; an unsigned number was expected
      - {id: b, size: n}
  field_within_a_size:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: field_within_a_size_two, size: 4}
      # expect: 23: the fields of 'a' cannot be read; a size delimits it; a structure without one
      #   was expected
      - {id: b, size: a.n}
  field_within_a_size_two:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
  not_a_boolean:
    -requirement: WIRE-DATA
    seq:
      # expect: 27: 'size-eos' is 'yes'; true or false was expected
      - {id: a, size-eos: yes}
  not_a_number:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      # expect: 36: '0b12' is not a number; decimal, 0x or 0b digits were expected
      - {id: b, type: u1, if: n == 0b12}
  not_an_integer:
    -requirement: WIRE-DATA
    # expect: 12: '-size' is 'not_an_integer'; a decimal or 0x number was expected
    -size: not_an_integer
    seq:
      - {id: a, type: u1}
  not_imported:
    -requirement: WIRE-DATA
    seq:
      - id: a
        # expect: 15: 'other' is not imported; there is none here
        type: other::two
  number_of_eight_bytes:
    -requirement: WIRE-DATA
    seq:
      # expect: 26: a number of 8 bytes in 'size'; 1, 2 or 4 bytes were expected; rubric --spec
      #   reads 8
      - {id: size, type: u8}
      # expect: 26: 'size' has 64 bits; expressions read numbers of at most 32
      - {id: body, size: size}
      - id: few
        # expect: 15: a number of 8 bytes in 'few'; 1, 2 or 4 bytes were expected; rubric --spec
        #   reads 8
        type: u8le
        valid:
          # expect: 16: the maximum 9007199254740992 is beyond 'few'; 0 to 9007199254740991 was
          #   expected
          max: 0x20000000000000
      - id: most
        # expect: 15: a number of 8 bytes in 'most'; 1, 2 or 4 bytes were expected; rubric --spec
        #   reads 8
        type: u8
        valid:
          # expect: 16: '0xfffffffffffffffe' is too large; at most 9007199254740991 was expected,
          #   which rules of a u8 can name
          max: 0xfffffffffffffffe
  number_too_large:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      # expect: 36: '99999999999999999999' is too large; at most 9007199254740991 was expected,
      #   which rules of a u8 can name
      - {id: b, type: u1, if: n == 99999999999999999999}
  overflow:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      # expect: 25: 'n * n' can overflow 64 bits; smaller numbers were expected
      - {id: b, size: n * n * n}
