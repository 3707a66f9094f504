meta:
  id: bad
  endian: be
types:
  am_type:
    -requirement: WIRE-DATA
    # expect: 19: AM type 256; 0 to 255 was expected
    # expect: 24: AM type 1 twice; each once
    -am-type: [1, 256, 1]
    seq:
      - {id: a, type: u1}
  am_type_of_carrier:
    -carrier: serial
    seq:
      - {id: type, type: u1}
      - id: payload
        size-eos: true
        type:
          switch-on: type
          cases:
            # expect: 13: case 3 leads to 'one', whose AM type is 4; the switch of a carrier and
            #   -am-type must agree
            3: one
            4: one
  one:
    -am-type: 4
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
  byte_order_of_one_byte:
    -requirement: WIRE-DATA
    seq:
      # expect: 23: a byte order for one byte; u1 or s1 was expected
      - {id: a, type: u1le}
  carrier_unknown:
    -requirement: WIRE-DATA
    # expect: 15: unknown carrier 'serail'; did you mean 'serial'?
    -carrier: serail
    seq:
      - {id: a, type: u1}
  crc_unknown:
    -requirement: WIRE-DATA
    # expect: 11: a CRC that the framing code does not have; polynomial 0x1021, initial 0, order
    #   le was expected
    -crc: {polynomial: 0x8005, initial: 0, order: le}
    seq:
      - {id: a, type: u1}
  framing_unknown:
    -requirement: WIRE-DATA
    # expect: 15: unknown framing 'slip'; known is hdlc
    -framing: slip
    seq:
      - {id: a, type: u1}
  if_not_a_condition:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 31: 'if' is not a condition; a comparison was expected
      - {id: b, type: u1, if: n}
