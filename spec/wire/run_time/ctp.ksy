meta:
  id: ctp
  title: TinyOS Collection Tree Protocol (TEP 123)
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: Carries data to the nearest root of a tree of nodes.
doc-ref: TEP 123; TEP 124

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
        0x70: ctp_routing
        0x71: ctp_data

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

  ctp_options:
    -mask: 8
    seq:
      - {id: pull, type: b1, doc: Asks for routing frames.}
      - {id: congestion, type: b1, doc: The sender had to drop a data frame.}
      - {id: r5, type: b1, -unnamed: true}
      - {id: r4, type: b1, -unnamed: true}
      - {id: r3, type: b1, -unnamed: true}
      - {id: r2, type: b1, -unnamed: true}
      - {id: r1, type: b1, -unnamed: true}
      - {id: r0, type: b1, -unnamed: true}

  ctp_routing:
    doc: A beacon with the route of its sender, inside a frame of the link estimator.
    doc-ref: TEP 123, section 5; TEP 124, section 3.3
    -am-type: 0x70
    seq:
      - id: leep_flags
        type: u1
        doc: Number of link entries; TEP 124 puts it into the upper half, TinyOS into the lower.
      - id: leep_seqno
        type: u1
        doc: Counts the frames of the link estimator.
      - id: options
        type: ctp_options
      - id: parent
        type: u2
        doc: The next node on the route.
      - id: etx
        type: u2
        doc: Transmissions to the root that the sender expects, in tenths.
      - id: links
        type: leep_entry
        repeat: eos
        doc: How well the sender hears its neighbours.

  leep_entry:
    doc: The quality of one link.
    doc-ref: TEP 124, section 3.3.2
    -size: 3
    seq:
      - id: node
        type: u2
        doc: The neighbour.
      - id: quality
        type: u1
        doc: How well it is heard, 255 at best.

  ctp_data:
    doc: A message on its way to a root.
    doc-ref: TEP 123, section 4
    -am-type: 0x71
    seq:
      - id: options
        type: ctp_options
      - id: thl
        type: u1
        doc: Hops so far.
      - id: etx
        type: u2
        doc: Transmissions to the root that the sender expects, in tenths.
      - id: origin
        type: u2
        doc: The node that made the message.
      - id: seqno
        type: u1
        doc: Counts the messages of the origin.
      - id: collect_id
        type: u1
        doc: Names the application's protocol.
      - id: data
        size-eos: true
        doc: As the application wrote it.
