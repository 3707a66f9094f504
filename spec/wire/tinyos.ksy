meta:
  id: tinyos
  title: TinyOS active messages on serial lines, TCP and 802.15.4
  endian: be
  license: Apache-2.0
doc: |
  The frames below every TinyOS protocol of this kit: the serial frame (its content, after
  unescaping), the active-message header on the serial line, the serial forwarder packet and the
  802.15.4 header of the CC2420 radio stack. Protocols import this file.
doc-ref: TEP 111, TEP 113, TEP 125

types:
  serial_frame:
    doc: |
      What is between two flags on the serial line, unescaped, without its CRC. The CRC-16 over
      these bytes follows them, low byte first.
    doc-ref: TEP 113, section 3.1
    -framing: hdlc
    -crc: {polynomial: 0x1021, initial: 0, order: le}
    -requirement: WIRE-SERIAL-KIND
    seq:
      - id: kind
        type: u1
        enum: serial_kind
        doc: Packet kind. An unknown kind is shown and kept.
      - id: seq_num
        type: u1
        if: kind == serial_kind::ack or kind == serial_kind::packet_ack
        doc: Of the frame to confirm, or of the frame that it confirms.
        -requirement: WIRE-SERIAL-SEQ
      - id: packet
        size-eos: true
        doc: From the dispatch byte on.

  sf_packet:
    doc: |
      A packet on a serial forwarder connection. The stream begins with two bytes from each side:
      'U' and a version.
    doc-ref: TinyOS serial forwarder protocol, version 2
    -requirement: WIRE-SF-LENGTH
    seq:
      - id: length
        type: u1
        valid:
          min: 1
        doc: Bytes of the packet.
      - id: packet
        size: length
        doc: From the dispatch byte on.

  am_header:
    doc: Dispatch byte and serial active-message header, 8 bytes.
    doc-ref: TEP 113, section 3.2; TEP 111
    -size: 8
    -requirement: WIRE-AM-HEADER
    seq:
      - id: dispatch
        type: u1
        enum: dispatch
        valid: dispatch::active_message
        doc: What the bytes after it are; this kit takes active messages.
        -requirement: WIRE-AM-DISPATCH
      - id: dest
        type: u2
        doc: AM address of the receiver; 0xffff is broadcast.
      - id: src
        type: u2
        doc: AM address of the sender.
      - id: length
        type: u1
        valid:
          max: 114
        doc: Bytes of the AM payload.
        -requirement: WIRE-AM-LENGTH
      - id: group
        type: u1
        doc: AM group, on the radio the PAN.
      - id: type
        type: u1
        doc: AM type.

  mac_header:
    doc: 802.15.4 data frame header with short addresses in one PAN, 9 bytes, little-endian.
    doc-ref: IEEE 802.15.4-2006, section 7.2.1; TEP 125
    -size: 9
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: fcf
        type: u2le
        doc: Frame control, 0x8841; 0x8861 asks for a link ack.
      - id: dsn
        type: u1
        doc: Data sequence number, counts up per node.
      - id: destpan
        type: u2le
        doc: PAN, the AM group.
      - id: dest
        type: u2le
        doc: AM address of the receiver.
      - id: src
        type: u2le
        doc: AM address of the sender.

  mac_ack:
    doc: 802.15.4 acknowledgement, without FCS, 3 bytes.
    doc-ref: IEEE 802.15.4-2006, section 7.2.2.3
    -size: 3
    -carrier: radio_ack
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: fcf
        type: u2le
        doc: Frame control, 0x0002.
      - id: dsn
        type: u1
        doc: Of the frame that it acknowledges.

enums:
  # IEEE 802.15.4-2006, section 7.2.1.1: the frame control fields of the CC2420 radio stack.
  frame_control:
    0x0002: ack
    0x8841: data
    0x8861: data_ack_request
  # Parts of a frame control field: its frame type, the request of a link ack, and all that makes a
  # data frame one with an AM message (type, no security, one PAN, a DSN, no information elements, modes
  # of both addresses; the two in the middle are bits of IEEE 802.15.4-2015, reserved before).
  frame_control_part:
    0x0007: type
    0x0020: ack_request
    0xcf4f: shape
  serial_kind:
    67: ack
    68: packet_ack
    69: packet_noack
    255: unknown
  dispatch:
    0: active_message
    1: cc1000
    2: ieee802154
    255: unknown
