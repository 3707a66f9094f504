# expect: 9:11: a CRC that the framing code does not have; polynomial 0x1021, initial 0, order le
#   was expected
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -crc: {polynomial: 0x8005, initial: 0, order: le}
    seq:
      - id: a
        type: u1
