meta:
  id: bad
  endian: be
types:
  instance_computed:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      # Where nothing else reads them, rubric --spec passes them over.
      # expect: 7: instance 'b' is computed; a number or a type at pos was expected
      b:
        value: a + 1
      # expect: 7: instance 'c' is computed; a number or a type at pos was expected
      c:
        pos: a
        type: u1
  instance_computed_read:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: body, size: b}
      # expect: 26: instance 'c' cannot be read here; it has no value that is always there
      - {id: more, size: c}
      - {id: ring, size: d}
      - {id: rest, size: e}
    instances:
      # expect: 7: instance 'b' is computed; a number or a type at pos was expected
      b: {value: a * 2}
      # expect: 7: instance 'c' is computed; a number or a type at pos was expected
      c: {value: a, if: a > 2}
      # expect: 7: instance 'd' is computed; a number or a type at pos was expected
      # expect: 18: instance 'd' takes too many others; or is computed from itself
      d: {value: d + 1}
      # expect: 7: instance 'e' is computed; a number or a type at pos was expected
      # expect: 18: unknown enum 'nowhere'; there is none here
      e: {value: a, enum: nowhere}
  instance_negative_pos:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      b:
        # expect: 14: pos -1; 0 to 65535 was expected
        pos: -1
        type: u1
  instance_of_neither_kind:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: rest, size-eos: true}
    instances:
      # expect: 7: instance 'b' is neither peek nor interpretation; a number at pos, or a type
      #   over size-eos bytes at pos was expected
      b:
        pos: 1
        type: two
  instance_without_pos:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      # expect: 7: an instance without pos
      b:
        type: u1
  interpretation_overlays_nothing:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: rest, size-eos: true}
    instances:
      # expect: 7: interpretation 'body' overlays nothing; a size-eos field without type at
      #   offset 2 was expected
      body:
        pos: 2
        size-eos: true
        type: two
  interpretation_overlays_typed:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: rest, size-eos: true, type: two}
    instances:
      # expect: 7: interpretation 'body' overlays nothing; a size-eos field without type at
      #   offset 1 was expected
      body:
        pos: 1
        size-eos: true
        type: two
  peek_behind_end:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      # expect: 7: peek 'b' lies after the end of 'peek_behind_end'; 'peek_behind_end' has at
      #   most 1 byte
      b:
        pos: 1
        type: u1
  peek_in_seq:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 26: instance 'b' cannot be read here; only instances read peeks
      - {id: rest, size: b}
    instances:
      b:
        pos: 0
        type: u1
  peek_with_condition:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      b:
        pos: 0
        type: u1
        # expect: 15: peek 'b' has a condition; conditions belong to interpretations
        if: a == 1
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
