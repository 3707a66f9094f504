meta:
  id: ftsp
  title: TinyOS time synchronization (FTSP)
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: Floods the time of a root through a network.
doc-ref: TEP 133; tinyos-2.x tos/lib/ftsp/TimeSyncMsg.h

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
        0x3D: time_sync_msg
        0xAA: early_time_sync_msg

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

  time_sync_msg:
    doc: The global time of its sender, in a packet with a time stamp.
    doc-ref: TEP 133; tinyos-2.x tos/lib/rfxlink/layers/TimeSyncMessageLayer.h
    -am-type: 0x3D
    -size: 14
    seq:
      - id: root_id
        type: u2
        doc: The node whose time is the global one.
      - id: node_id
        type: u2
        doc: The sender.
      - id: seq_num
        type: u1
        doc: Counts the rounds of the root.
      - id: global_time
        type: u4
        doc: Global time of the event that the time stamp is about, in ticks.
      - id: type
        type: u1
        -expect: 0x3E
        doc: AM type of the packet within; 0x3e is FTSP.
      - id: time_stamp
        type: s4
        doc: From sending the packet back to the event, in ticks.

  early_time_sync_msg:
    doc: The same before TinyOS 2.1.1, where the radio corrected the global time as it sent it.
    -am-type: 0xAA
    seq:
      - id: root_id
        type: u2
        doc: The node whose time is the global one.
      - id: node_id
        type: u2
        doc: The sender.
      - id: seq_num
        type: u1
        doc: Counts the rounds of the root.
      - id: global_time
        type: u4
        doc: Global time when the packet was sent, in ticks.
      - id: local_time
        size-eos: true
        doc: Nothing, or the place of the receiver's time.
