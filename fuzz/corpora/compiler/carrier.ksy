meta:
  id: carrier
  endian: be
  imports: [tinyos]
-carrier: serial
-requirement: WIRE-AM-HEADER
seq:
  - {id: am, type: 'tinyos::am_header'}
  - id: payload
    size: am.length
    -requirement: WIRE-AM-LENGTH
    type:
      switch-on: am.type
      cases: {0x93: reading}
types:
  reading:
    -am-type: 0x93
    -requirement: WIRE-OSCILLOSCOPE
    seq:
      - {id: n, type: u2}
