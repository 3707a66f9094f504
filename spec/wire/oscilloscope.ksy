meta:
  id: oscilloscope
  title: TinyOS Oscilloscope
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: |
  The demo application of TinyOS: a mote sends ten readings of its sensor in a message. It shows
  that another protocol over the same frames is one more file here.
doc-ref: tinyos-2.x apps/Oscilloscope/Oscilloscope.h

-carrier: serial
-requirement: WIRE-AM-HEADER
seq:
  - id: am
    type: tinyos::am_header
  - id: payload
    size: am.length
    -requirement: WIRE-AM-LENGTH
    type:
      switch-on: am.type
      cases: &messages
        0x93: oscilloscope_msg

types:
  radio_i_frame:
    -carrier: radio_i
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: mac
        type: tinyos::mac_header
      - id: network
        type: u1
        valid: 0x3f
        -requirement: WIRE-RADIO-NETWORK
      - id: type
        type: u1
      - id: payload
        size-eos: true
        -requirement: WIRE-RADIO-LENGTH
        type:
          switch-on: type
          cases: *messages

  radio_t_frame:
    -carrier: radio_t
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: mac
        type: tinyos::mac_header
      - id: type
        type: u1
      - id: payload
        size-eos: true
        -requirement: WIRE-RADIO-LENGTH
        type:
          switch-on: type
          cases: *messages

  oscilloscope_msg:
    doc: Readings of one mote.
    -am-type: 0x93
    -size: 28
    -requirement: WIRE-OSCILLOSCOPE
    seq:
      - id: version
        type: u2
        doc: Version of the interval.
      - id: interval
        type: u2
        doc: Sampling period.
        -unit: {symbol: ms}
      - id: id
        type: u2
        doc: Mote id of the sender.
      - id: count
        type: u2
        doc: Number of the first reading.
      - id: readings
        type: u2
        repeat: expr
        repeat-expr: 10
        doc: Sensor readings.
