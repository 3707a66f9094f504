# The frames of @name@, in Kaitai Struct. Keys that begin with - are Rubric's.
meta:
  id: @name@
  title: Readings of sensors, on request
  endian: be
  imports:
    - tinyos
doc: A node answers a request with what its application has measured.

# On serial lines.
-carrier: serial
seq:
  - id: am
    type: tinyos::am_header
  - id: payload
    size: am.length
    type:
      switch-on: am.type
      cases: &messages
        0xa1: request
        0xa2: reading

types:
  # By radio.
  radio_i_frame:
    -carrier: radio_i
    seq:
      - id: mac
        type: tinyos::mac_header
      - id: network
        type: u1
        valid: 0x3f
      - id: type
        type: u1
      - id: payload
        size-eos: true
        type:
          switch-on: type
          cases: *messages

  request:
    doc: Asks a node for its reading.
    -am-type: 0xa1
    seq:
      - id: number
        type: u1
        doc: Tells one request from the next.

  reading:
    doc: The answer.
    -am-type: 0xa2
    seq:
      - id: number
        type: u1
        doc: Of the request.
      - id: value
        type: u2
        doc: What was measured last.
