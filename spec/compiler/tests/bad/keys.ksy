meta:
  id: bad
  endian: be
types:
  id_keyword:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: 'class' cannot be the name of a field; it is a word of C++ or of the profile
      - {id: class, type: u1}
  id_missing:
    -requirement: WIRE-DATA
    seq:
      # expect: 9: a field without id; id: was expected
      - type: u1
  id_not_snake_case:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: name 'seqNum'; lower snake case was expected
      - {id: seqNum, type: u1}
  id_too_long:
    -requirement: WIRE-DATA
    seq:
      # expect: 14: name 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa'; at
      #   most 64 characters
      - {id: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa, type: u1}
  key_not_a_word:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        # expect: 9: a key of a field is a list; a plain word was expected
        [b, c]: d
  key_unknown:
    -requirement: WIRE-DATA
    seq:
      # expect: 17: unknown key 'typ' of a field; did you mean 'type'?
      - {id: a, typ: u1}
  key_unknown_type:
    # expect: 5: unknown key '-requirment' of a type; did you mean '-requirement'?
    -requirment: WIRE-DATA
    seq:
      - {id: a, type: u1}
  key_wrong_kind:
    -requirement: WIRE-DATA
    seq:
      # expect: 32: 'doc' is a list; a value was expected
      - {id: a, type: u1, doc: [a, b]}
  name_missing:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 25: a name is missing; a word was expected after '.' or '::'
      - {id: b, size: a.}
  # expect: 3: type 'requirement_missing' without requirement; -requirement: was expected
  requirement_missing:
    seq:
      - {id: a, type: u1}
  requirement_unknown:
    # expect: 19: unknown requirement 'WIRE-DAT'; did you mean 'WIRE-DATA'?
    -requirement: WIRE-DAT
    seq:
      # expect: 41: unknown requirement 'WIRE-DATUM'; did you mean 'WIRE-DATA'?
      - {id: a, type: u1, -requirement: WIRE-DATUM}
  shown_name:
    -requirement: WIRE-DATA
    seq:
      # expect: 34: name 'Shown'; lower snake case was expected
      - {id: a, type: u1, -name: Shown}
  shown_name_of_type:
    -requirement: WIRE-DATA
    # expect: 12: name 'One'; lower snake case was expected
    -name: One
    seq:
      - {id: a, type: u1}
  unit_on_enum:
    -requirement: WIRE-DATA
    seq:
      # expect: 47: -unit on 'a'; a plain number was expected
      - {id: a, type: u1, enum: color, -unit: {symbol: ms}}
  unit_scale:
    -requirement: WIRE-DATA
    seq:
      # expect: 54: 'scale' is 'ten'; a decimal number was expected
      - {id: a, type: u1, -unit: {symbol: ms, scale: ten}}
  unit_without_symbol:
    -requirement: WIRE-DATA
    seq:
      # expect: 34: a unit without symbol; symbol: was expected
      - {id: a, type: u2, -unit: {scale: 0.5}}
enums:
  color:
    1: red
    2: green
