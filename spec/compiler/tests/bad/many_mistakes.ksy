# expect: 20:5: '-requirement' twice in a type; it is already in line 19
# expect: 21:15: unknown carrier 'usb'; known are serial, radio_i, radio_t, radio_ack, radio_beacon, radio_command
# expect: 23:13: name 'Length'; lower snake case was expected
# expect: 27:15: unknown enum 'colour'; did you mean 'color'?
# expect: 28:16: the minimum 3 is above the maximum 2; no value would be valid
# expect: 30:20: the size 'kind - 1' can be negative; it is -1 to 254; 'valid' can narrow what it
#   is made of
# expect: 32:9: unknown key 'typ' of a field; did you mean 'type'?
# expect: 33:15: unknown type 'u3'; did you mean 'u1'?
# expect: 34:9: a field without id; id: was expected
# expect: 36:7: peek 'peek' is not an unsigned number; an instance is a number at pos, or a type over
#   size-eos bytes at pos
# expect: 43:5: duplicate enum value 2; line 42 names it already
meta:
  id: bad
  endian: be
types:
  one:
    -requirement: WIRE-DATA
    -requirement: WIRE-DATA
    -carrier: usb
    seq:
      - id: Length
        type: u1
      - id: kind
        type: u1
        enum: colour
        valid: {min: 3, max: 2}
      - id: body
        size: kind - 1
      - id: tail
        typ: u1
        type: u3
      - type: u2
    instances:
      peek:
        pos: 0
        type: f4
enums:
  color:
    1: red
    2: green
    0x2: blue
