# expect: 17:13: case 3 leads to 'one', whose AM type is 4; the switch of a carrier and -am-type
#   must agree
meta:
  id: bad
  endian: be
types:
  frame:
    -carrier: serial
    seq:
      - id: type
        type: u1
      - id: payload
        size-eos: true
        type:
          switch-on: type
          cases:
            3: one
            4: one
  one:
    -am-type: 4
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
