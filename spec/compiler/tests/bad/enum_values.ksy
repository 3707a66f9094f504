meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
enums:
  # expect: 3: an enum without values
  empty: {}
  name_null:
    1: red
    # expect: 8: an enum value is nothing; a value was expected; quote the word 'null'
    3: null
  value_not_number:
    1: red
    # expect: 5: enum value 'blue'; a number of 0 to 0xffffffff was expected
    blue: 3
  value_without_id:
    1: red
    # expect: 8: an enum value without id; id: was expected
    2: {doc: Green.}
  duplicate_name:
    1: red
    # expect: 5: duplicate enum value 'red'; it is already in line {-2}
    3: red
  duplicate_value:
    2: green
    # expect: 5: duplicate enum value 2; line {-2} names it already
    0x02: blue
  twice: {1: red}
  # expect: 3: 'twice' twice in enums; it is already in line {-2}
  twice: {3: blue}
