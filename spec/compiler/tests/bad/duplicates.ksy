meta:
  id: bad
  endian: be
types:
  carrier:
    -requirement: WIRE-DATA
    -carrier: serial
    seq:
      - {id: a, type: u1}
  carrier_again:
    -requirement: WIRE-DATA
    # expect: 15: duplicate carrier 'serial'; line {-6} has it already
    -carrier: serial
    seq:
      - {id: b, type: u2}
  field:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      # expect: 14: duplicate field 'a'; it is already in line {-2}
      - {id: a, type: u1}
  instance:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
    instances:
      # expect: 7: duplicate field 'a'; it is already in line {-3}
      a:
        pos: 0
        type: u1
  key:
    -requirement: WIRE-DATA
    seq:
      - id: a
        type: u1
        # expect: 9: 'type' twice in a field; it is already in line {-2}
        type: u2
  switched:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - id: b
        size-eos: true
        type:
          switch-on: a
          cases:
            1: two
            # expect: 13: duplicate case 1; line {-2} has it already
            0x01: two
  two:
    -requirement: WIRE-DATA
    seq:
      - {id: b, type: u2}
  # expect: 3: 'two' twice in types; it is already in line {-5}
  two:
    seq: []
