meta:
  id: bad
  endian: be
types:
  arguments_of_a_type:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: arguments for type 'arguments_of_a_type_two': 1; as many as its parameters
      #   were expected: 0
      - {id: a, type: arguments_of_a_type_two(1)}
      # expect: 23: unknown type 'f8'; a float has 4 bytes; 'size: 8' keeps them
      - {id: b, type: f8}
  arguments_of_a_type_two:
    -requirement: WIRE-DATA
    seq:
      - {id: c, type: u1}
  params:
    -requirement: WIRE-DATA
    params:
      # expect: 7: type 'params' has parameters; fields were expected, by which alone its size is
      #   known; rubric --spec reads it
      - {id: length, type: u1}
      - {id: many, type: bool}
      # expect: 26: a parameter of type 'str'; u1, u2, u4, s1, s2, s4, bool or b1 to b32 was
      #   expected
      - {id: name, type: str}
    seq:
      # expect: 23: 'length' has no fields to read; it is a parameter
      - {id: a, size: length.more}
  params_two:
    -requirement: WIRE-DATA
    -am-type: 9
    params:
      # expect: 7: parameters of a message or frame, 'params_two'; nothing says what they are
      # expect: 7: too many parameters: 9; at most 8 are read
      # expect: 7: type 'params_two' has parameters; fields were expected, by which alone its
      #   size is known; rubric --spec reads it
      - {id: p1, type: u1}
      # expect: 9: unknown enum 'none'; there is none here
      - {id: p2, type: u1, enum: none}
      - {id: p3, type: u1}
      - {id: p4, type: u1}
      - {id: p5, type: u1}
      - {id: p6, type: u1}
      - {id: p7, type: u1}
      - {id: p8, type: u1}
      - {id: p9, type: u1}
    seq:
      - {id: a, type: u1}
  type_cycle:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: type_cycle_two}
  type_cycle_two:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: type 'type_cycle' contains itself; types must not form a circle
      - {id: b, type: type_cycle}
  type_cycle_by_switch:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            # expect: 13: type 'type_cycle_by_switch' contains itself; types must not form a
            #   circle
            1: type_cycle_by_switch
  # expect: 3: type 'type_without_fields' without fields; seq: with a field was expected
  type_without_fields:
    -requirement: WIRE-DATA
