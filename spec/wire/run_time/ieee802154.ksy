meta:
  id: ieee802154
  title: IEEE 802.15.4 beacon and command frames
  endian: be
  bit-endian: le
  license: Apache-2.0
  imports:
    - tinyos
doc: What coordinators and devices of a PAN say to each other, beside data.
doc-ref: IEEE 802.15.4-2006, section 7.2.2

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
        _: am_message

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

  am_message:
    doc: The payload of any message.
    seq:
      - id: data
        size-eos: true
        doc: As the application wrote it.

  beacon_frame:
    doc: What a coordinator announces, mostly at regular times.
    doc-ref: IEEE 802.15.4-2006, section 7.2.2.1
    -carrier: radio_beacon
    -name: beacon
    seq:
      - id: frame_type
        type: b3
        valid: 0
        doc: Kind of the frame.
      - id: security
        type: b1
        valid: false
        doc: Whether the rest is secured; such frames stay opaque.
      - id: pending
        type: b1
        doc: The sender has more for the receiver.
      - id: ack_request
        type: b1
        valid: false
        doc: Asks for a link ack.
      - id: one_pan
        type: b1
        valid: false
        doc: The source's PAN is left out, as it is the receiver's.
      - id: reserved
        type: b3
        doc: Nothing yet.
      - id: dest_mode
        type: b2
        valid: 0
        doc: Address of the receiver, 0 none, 2 short, 3 extended.
      - id: version
        type: b2
        valid:
          max: 1
        doc: 0 for 2003, 1 for 2006.
      - id: src_mode
        type: b2
        valid:
          any-of: [2, 3]
        doc: Address of the sender, 0 none, 2 short, 3 extended.
      - id: bsn
        type: u1
        doc: Counts the beacons.
      - id: src_pan
        type: u2le
        doc: PAN of the coordinator.
      - id: src
        type: u2le
        if: src_mode == 2
        doc: Short address of the coordinator.
      - id: src_ext
        type: extended_address
        if: src_mode == 3
        doc: Extended address of the coordinator.
      - id: content
        type: beacon_content
        doc: Superframe, guaranteed time slots, and what waits.

  extended_address:
    doc: An address of 64 bits.
    -size: 8
    seq:
      - id: low
        type: u4le
        doc: Its lower half.
      - id: high
        type: u4le
        doc: Its upper half.

  beacon_content:
    doc: The superframe, and the slots that are given away.
    seq:
      - id: beacon_order
        type: b4
        doc: A beacon every 15.36 ms (at 250 kbit/s) times 2 to this; 15 is none.
      - id: superframe_order
        type: b4
        doc: The superframe takes 15.36 ms times 2 to this.
      - id: final_cap_slot
        type: b4
        doc: Last slot of the contention access period.
      - id: battery_life_extension
        type: b1
        doc: The coordinator listens only briefly after a beacon.
      - id: reserved
        type: b1
        doc: Nothing yet.
      - id: pan_coordinator
        type: b1
        doc: The sender coordinates the PAN.
      - id: association_permit
        type: b1
        doc: Devices may join.
      - id: gts_count
        type: b3
        doc: Guaranteed time slots that are given away.
      - id: gts_reserved
        type: b4
        doc: Nothing yet.
      - id: gts_permit
        type: b1
        doc: Devices may ask for a slot.
      - id: gts_directions
        type: u1
        if: gts_count > 0
        doc: A bit for each slot; 1 is to the device.
      - id: gts_list
        type: gts
        repeat: expr
        repeat-expr: gts_count
        doc: The slots.
      - id: rest
        type: beacon_rest
        doc: What waits for devices, and what a higher layer adds.

  gts:
    doc: A guaranteed time slot.
    -size: 3
    seq:
      - id: device
        type: u2le
        doc: Short address of its owner.
      - id: start
        type: b4
        doc: Its first slot of the superframe.
      - id: length
        type: b4
        doc: In slots.

  beacon_rest:
    doc: The devices for which something waits, and the beacon's payload.
    seq:
      - id: short_count
        type: b3
        doc: Short addresses.
      - id: reserved_1
        type: b1
        doc: Nothing yet.
      - id: extended_count
        type: b3
        doc: Extended addresses.
      - id: reserved_2
        type: b1
        doc: Nothing yet.
      - id: short
        type: u2le
        repeat: expr
        repeat-expr: short_count
        doc: Devices that are to ask.
      - id: extended
        type: extended_address
        repeat: expr
        repeat-expr: extended_count
        doc: Devices that are to ask.
      - id: payload
        size-eos: true
        doc: Of a higher layer.

  command_frame:
    doc: How devices join and leave a PAN, and ask a coordinator.
    doc-ref: IEEE 802.15.4-2006, sections 7.2.2.4 and 7.3
    -carrier: radio_command
    -name: command
    seq:
      - id: frame_type
        type: b3
        valid: 3
        doc: Kind of the frame.
      - id: security
        type: b1
        valid: false
        doc: Whether the rest is secured; such frames stay opaque.
      - id: pending
        type: b1
        doc: The sender has more for the receiver.
      - id: ack_request
        type: b1
        doc: Asks for a link ack.
      - id: one_pan
        type: b1
        doc: The source's PAN is left out, as it is the receiver's.
      - id: reserved
        type: b3
        doc: Nothing yet.
      - id: dest_mode
        type: b2
        valid:
          any-of: [0, 2, 3]
        doc: Address of the receiver, 0 none, 2 short, 3 extended.
      - id: version
        type: b2
        valid:
          max: 1
        doc: 0 for 2003, 1 for 2006.
      - id: src_mode
        type: b2
        valid:
          any-of: [0, 2, 3]
        doc: Address of the sender, 0 none, 2 short, 3 extended.
      - id: dsn
        type: u1
        doc: Counts the frames of the sender.
      - id: dest_pan
        type: u2le
        if: dest_mode != 0
        doc: PAN of the receiver.
      - id: dest
        type: u2le
        if: dest_mode == 2
        doc: Short address of the receiver.
      - id: dest_ext
        type: extended_address
        if: dest_mode == 3
        doc: Extended address of the receiver.
      - id: src_pan
        type: u2le
        if: src_mode != 0 and not one_pan
        doc: PAN of the sender.
      - id: src
        type: u2le
        if: src_mode == 2
        doc: Short address of the sender.
      - id: src_ext
        type: extended_address
        if: src_mode == 3
        doc: Extended address of the sender.
      - id: content
        type: command_content
        doc: The command.

  command_content:
    doc: What is asked or answered.
    seq:
      - id: id
        type: u1
        enum: command_id
        doc: The command.
      - id: parameters
        size-eos: true
        type:
          switch-on: id
          cases:
            command_id::association_request: association_request
            command_id::association_response: association_response
            command_id::disassociation: disassociation
            command_id::coordinator_realignment: coordinator_realignment
            command_id::gts_request: gts_request

  association_request:
    doc: A device wants to join.
    -size: 1
    seq:
      - id: may_coordinate
        type: b1
        doc: It could become PAN coordinator.
      - id: full_function
        type: b1
        doc: It is a full-function device.
      - id: mains_powered
        type: b1
        doc: It has mains power.
      - id: listens_when_idle
        type: b1
        doc: Its receiver is on while idle.
      - id: reserved
        type: b2
        doc: Nothing yet.
      - id: secure
        type: b1
        doc: It can secure frames.
      - id: wants_address
        type: b1
        doc: It wants a short address.

  association_response:
    doc: Whether it may.
    -size: 3
    seq:
      - id: address
        type: u2le
        doc: The short address that it gets.
      - id: status
        type: u1
        enum: association_status
        doc: The answer.

  disassociation:
    doc: A device leaves, or has to.
    -size: 1
    seq:
      - id: reason
        type: u1
        enum: disassociation_reason
        doc: Why.

  coordinator_realignment:
    doc: The PAN changes, or an orphan gets its coordinator back.
    seq:
      - id: pan
        type: u2le
        doc: The PAN from now on.
      - id: coordinator
        type: u2le
        doc: Short address of the coordinator.
      - id: channel
        type: u1
        doc: The channel from now on.
      - id: address
        type: u2le
        doc: Short address of the orphan, else 0xffff.
      - id: page
        size-eos: true
        doc: The channel page, if it changes.

  gts_request:
    doc: A device asks for a guaranteed time slot, or gives one back.
    -size: 1
    seq:
      - id: length
        type: b4
        doc: In slots.
      - id: to_device
        type: b1
        doc: The device receives in it.
      - id: allocate
        type: b1
        doc: It asks; else it gives back.
      - id: reserved
        type: b2
        doc: Nothing yet.

enums:
  command_id:
    1: association_request
    2: association_response
    3: disassociation
    4: data_request
    5: pan_id_conflict
    6: orphan
    7: beacon_request
    8: coordinator_realignment
    9: gts_request
  association_status:
    0: successful
    1: pan_at_capacity
    2: access_denied
  disassociation_reason:
    1: coordinator_wishes
    2: device_wishes
