meta:
  id: bad
  endian: be
types:
  bit_outside_mask:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: a, type: b8}
  bits_absent:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 14: the bits 'b' repeat or may be absent; bits that are always there, once, were
      #   expected
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: b, type: b8, if: a == 1}
  bits_in_five_bytes:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: a, type: b4}
      # expect: 14: the bits 'b' lie in five bytes; at most four are read as one number
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: b, type: b32}
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: c, type: b4}
  bits_too_many:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: a number of 33 bits; 1 to 32 were expected
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: a, type: b33}
  bits_within_a_byte:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: the bits 'a' end within a byte; 3 more were expected
      # expect: 23: bits outside a mask; -mask: 8 or -mask: 16 was expected at the type; rubric
      #   --spec reads bits
      - {id: a, type: b5}
      - {id: b, type: u1}
  mask_bit_type:
    -mask: 8
    seq:
      - {id: b7, type: b1}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      # expect: 24: a mask has only bits; type: b1 was expected
      - {id: b0, type: u1}
  mask_bit_without_id:
    -mask: 8
    seq:
      - {id: b7, type: b1}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      # expect: 9: a bit without id; id: was expected
      - {type: b1}
  mask_bits:
    # expect: 12: 7 bits in a mask of 8; each bit is named once, from the highest down
    -mask: 8
    seq:
      - {id: bit6, type: b1}
      - {id: bit5, type: b1}
      - {id: bit4, type: b1}
      - {id: bit3, type: b1}
      - {id: bit2, type: b1}
      - {id: bit1, type: b1}
      - {id: bit0, type: b1}
  mask_declared_size:
    -mask: 8
    # expect: 12: -size 2 does not add up; the mask takes 1 byte
    -size: 2
    seq:
      - {id: b7, type: b1}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      - {id: b0, type: b1}
  mask_of_numbers:
    -mask: 8
    seq:
      - {id: bit7, type: b1}
      - {id: bit6, type: b1}
      - {id: bit5, type: b1}
      - {id: bit4, type: b1}
      - {id: bit3, type: b1}
      - {id: bit2, type: b1}
      - {id: bit1, type: b1}
      # expect: 26: a mask has only bits; type: b1 was expected
      - {id: bit0, type: u1}
  mask_width:
    # expect: 12: a mask of 12 bits; 8 or 16 was expected
    -mask: 12
    seq:
      - {id: a, type: b1}
  mask_with_instances:
    -mask: 8
    seq:
      - {id: b7, type: b1}
      - {id: b6, type: b1}
      - {id: b5, type: b1}
      - {id: b4, type: b1}
      - {id: b3, type: b1}
      - {id: b2, type: b1}
      - {id: b1, type: b1}
      - {id: b0, type: b1}
    # expect: 5: instances in a mask; a mask has only bits
    instances: {}
