meta:
  id: printf
  title: TinyOS printf
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: Text that a mote prints through the printf library.
doc-ref: tinyos-2.x tos/lib/printf/printf.h

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
        100: printf_msg

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

  printf_msg:
    doc: A piece of the text; the buffer is as long as the mote was built for, 28 bytes if not told.
    -am-type: 100
    seq:
      - id: buffer
        type: str
        size-eos: true
        encoding: UTF-8
        pad-right: 0
        doc: Characters, filled up with zeros.
