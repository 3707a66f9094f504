# expect: 9:15: carrier radio_t does not end in a message; at the end size-eos: true with a switch
#   on a u1 field was expected
meta:
  id: bad
  endian: be
-requirement: WIRE-AM-HEADER
types:
  frame:
    -carrier: radio_t
    seq:
      - id: type
        type: u1
