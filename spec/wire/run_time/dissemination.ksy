meta:
  id: dissemination
  title: TinyOS dissemination (TEP 118)
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: Brings small values to every node of a network.
doc-ref: TEP 118; tinyos-2.x tos/lib/net/drip/DisseminationEngine.h

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
        0x60: dissemination_message
        0x61: dissemination_probe_message

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

  dissemination_message:
    doc: A value and its version.
    -am-type: 0x60
    seq:
      - id: key
        type: u2
        doc: Names the value.
      - id: seqno
        type: u4
        doc: Version of the value; 0 is unknown.
      - id: data
        size-eos: true
        doc: The value.

  dissemination_probe_message:
    doc: Asks the neighbours for their version of a value.
    -am-type: 0x61
    -size: 2
    seq:
      - id: key
        type: u2
        doc: Names the value.
