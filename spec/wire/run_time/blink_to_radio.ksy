meta:
  id: blink_to_radio
  title: TinyOS BlinkToRadio
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: The radio tutorial of TinyOS; a mote broadcasts a counter.
doc-ref: tinyos-2.x apps/tutorials/BlinkToRadio/BlinkToRadio.h

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
        6: blink_to_radio_msg

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

  blink_to_radio_msg:
    doc: The counter of one mote.
    -am-type: 6
    -size: 4
    seq:
      - id: nodeid
        type: u2
        doc: Mote id of the sender.
      - id: counter
        type: u2
        doc: Counts up with each message.
