meta:
  id: rubicon
  title: RUBICON Communication Layer
  endian: be
  license: Apache-2.0
  imports:
    - tinyos
doc: |
  The messages of the RUBICON Communication Layer on TinyOS active messages: joins, network
  messages between islands, and what applications carry in them. seq is syntax: bytes that break
  it are malformed. instances are interpretations: bytes that do not fit one stay opaque, with a
  note.
doc-ref: "paper: The Structure of the Communication Layer"

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
      cases:
        11: command
        12: serial_data
        20: learning_module_cmd
        21: learning_module_float_cmd
        28: net_msg
        37: config

types:
  radio_i_frame:
    doc: On the radio, with the 6LoWPAN network byte (I-frame).
    doc-ref: TEP 125
    -carrier: radio_i
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: mac
        type: tinyos::mac_header
      - id: network
        type: u1
        valid: 0x3f
        doc: NALP code of TinyOS in 6LoWPAN.
        -requirement: WIRE-RADIO-NETWORK
      - id: type
        type: u1
        enum: am_type
        doc: AM type.
      - id: payload
        size-eos: true
        -requirement: WIRE-RADIO-LENGTH
        type:
          switch-on: type
          cases: &radio_messages
            'am_type::temp': rssi_beacon
            'am_type::join': join_request
            'am_type::join_reply': join_reply
            'am_type::net': net_msg
            'am_type::ack_join': ack_join

  radio_t_frame:
    doc: On the radio, without a network byte (T-frame, TFRAMES builds).
    doc-ref: TEP 125
    -carrier: radio_t
    -requirement: WIRE-RADIO-HEADER
    seq:
      - id: mac
        type: tinyos::mac_header
      - id: type
        type: u1
        enum: am_type
        doc: AM type.
      - id: payload
        size-eos: true
        -requirement: WIRE-RADIO-LENGTH
        type:
          switch-on: type
          cases: *radio_messages

  # Addresses and descriptors.

  r_addr:
    doc: RUBICON address of a mote, a sink, or the PC or robot of an island.
    doc-ref: "paper: The RUBICON Addressing Scheme"
    -am-type: 31
    -size: 4
    -requirement: WIRE-R-ADDR
    seq:
      - id: pid
        type: u2
        enum: pid
        doc: Island, the PEIS id of its proxy.
      - id: devid
        type: u2
        enum: devid
        doc: Mote in the island; its TinyOS node id.

  mote_desc:
    doc: What a mote is and carries.
    doc-ref: "paper: Component Management"
    -size: 4
    -requirement: WIRE-MOTE-DESC
    seq:
      - id: mote_type
        type: u1
        enum: mote_type
        doc: Platform.
      - id: transducers
        type: transducer_mask
        doc: Sensors on board.
      - id: actuators
        type: actuator_mask
        doc: Actuators on board.

  transducer_mask:
    doc: Transducers, a bit each.
    -mask: 16
    seq:
      - {id: bit15, type: b1, -unnamed: true}
      - {id: bit14, type: b1, -unnamed: true}
      - {id: bit13, type: b1, -unnamed: true}
      - {id: rssi5, type: b1}
      - {id: rssi4, type: b1}
      - {id: rssi3, type: b1}
      - {id: rssi2, type: b1}
      - {id: rssi1, type: b1}
      - {id: magnetic, type: b1}
      - {id: humid, type: b1}
      - {id: mic, type: b1}
      - {id: pir, type: b1}
      - {id: accel_y, type: b1}
      - {id: accel_x, type: b1}
      - {id: temp, type: b1}
      - {id: light, type: b1}

  actuator_mask:
    doc: Actuators, a bit each.
    -mask: 8
    seq:
      - {id: bit7, type: b1, -unnamed: true}
      - {id: bit6, type: b1, -unnamed: true}
      - {id: bit5, type: b1, -unnamed: true}
      - {id: bit4, type: b1, -unnamed: true}
      - {id: bit3, type: b1, -unnamed: true}
      - {id: bit2, type: b1, -unnamed: true}
      - {id: open, type: b1}
      - {id: led, type: b1}

  # Network and transport level.

  net_msg:
    doc: |
      The message of the network level. Over the radio only nbytes of the payload are sent; on the
      serial line the whole 114 bytes, and bytes after the payload are left over from earlier
      frames.
    doc-ref: "paper: The Network level"
    -am-type: 28
    -size: 114
    -requirement: WIRE-NET-HEADER
    seq:
      - id: dest
        type: r_addr
        doc: To whom.
      - id: src
        type: r_addr
        doc: From whom.
      - id: reliable
        type: u1
        valid:
          max: 1
        doc: 1 asks for a RUBICON acknowledgement.
        -requirement: WIRE-NET-RELIABLE
      - id: seq_num
        type: u2
        doc: Sequence number.
      - id: nbytes
        type: u1
        valid:
          min: 2
          max: 102
        doc: Bytes of the payload, TRANSID and APPID included.
        -requirement: WIRE-NET-NBYTES
      - id: payload
        size: nbytes
        doc: The message of the transport level; who sent it decides what a learning code means.
        -requirement: WIRE-NET-PAYLOAD
        type:
          switch-on: src.devid
          cases:
            'devid::null': app_msg_from_pc
            _: app_msg

  app_msg:
    doc: Message of the transport level, from a mote or a sink.
    doc-ref: "paper: Message Dispatcher"
    -am-type: 30
    -size: 102
    -requirement: WIRE-APP-HEADER
    seq: &app_seq
      - id: trans_id
        type: u1
        enum: component
        doc: Transport component.
      - id: app_id
        type: u1
        enum: component
        doc: Application component.
      - id: payload
        size-eos: true
        doc: The application's bytes.
    instances:
      type_byte: &type_byte
        pos: 2
        type: u1
        doc: The first byte of the payload.
      control_layer: &control_layer
        -name: body
        if: trans_id == component::connless and app_id == component::control_layer
        pos: 2
        size-eos: true
        type:
          switch-on: type_byte
          cases:
            16: serial_joined
            35: updates
            36: read_updates
      mockup: &mockup
        -name: body
        if: trans_id == component::connless and app_id == component::mockup
        pos: 2
        size-eos: true
        type:
          switch-on: type_byte
          cases:
            1: demo
            34: demo_data
            36: read_updates
      learning:
        -name: body
        if: trans_id == component::connless and app_id == component::learning
        pos: 2
        size-eos: true
        type:
          switch-on: type_byte
          cases:
            23: learning_notification
            24: learning_module_down
            25: learning_output
      ack: &ack
        -name: body
        if: trans_id == component::rubicon_ack
        pos: 2
        size-eos: true
        type: rubicon_ack
      ack_seq_only: &ack_seq_only
        -name: body
        if: trans_id == component::rubicon_ack
        pos: 2
        size-eos: true
        type: rubicon_ack_seq_only
      synaptic: &synaptic
        -name: body
        if: trans_id == component::syn_channel
        pos: 2
        size-eos: true
        type: synaptic_data

  app_msg_from_pc:
    doc: Message of the transport level, from the PC or robot of an island.
    doc-ref: "paper: Message Dispatcher"
    -name: app_msg
    -size: 102
    -requirement: WIRE-APP-HEADER
    seq: *app_seq
    instances:
      type_byte: *type_byte
      control_layer: *control_layer
      mockup: *mockup
      learning:
        -name: body
        if: trans_id == component::connless and app_id == component::learning
        pos: 2
        size-eos: true
        type:
          switch-on: type_byte
          cases:
            8: broadcast_cmd
            9: syn_create_cmd
            10: syn_create_cmd
            11: syn_create_cmd
            12: learning_module_cmd
            16: learning_module_cmd
            18: learning_module_cmd
            20: learning_module_float_cmd
            22: learning_module_float_cmd
            28: learning_module_float_cmd
            _: netid_cmd
      ack: *ack
      ack_seq_only: *ack_seq_only
      synaptic: *synaptic

  rubicon_ack:
    doc: Acknowledgement of a reliable message, as release 1.0 sends it.
    doc-ref: "paper: Rubicon ACK"
    -size: 4
    -requirement: WIRE-RUBICON-ACK
    seq:
      - id: type
        type: u1
        enum: am_type
        doc: Kind of the body.
        -expect: am_type::learning_notification
      - id: seq_num
        type: u2
        doc: Of the message that it acknowledges.
      - id: ack
        type: u1
        doc: 0 is success.

  rubicon_ack_seq_only:
    doc: Acknowledgement of a reliable message, as the paper describes it.
    doc-ref: "paper: Rubicon ACK"
    -size: 2
    -requirement: WIRE-RUBICON-ACK
    seq:
      - id: seq_num
        type: u2
        doc: Of the message that it acknowledges.

  synaptic_data:
    doc: The values of a synaptic channel.
    doc-ref: "paper: Synaptic Communication"
    -size: 100
    -requirement: WIRE-SYNAPTIC-DATA
    seq:
      - id: values
        type: f4le
        repeat: eos
        doc: One for each connection, at most ten; after a forwarding sink stale values follow.

  # Joining an island.

  join_request:
    doc: A mote asks to join.
    doc-ref: "paper: Component Management"
    -am-type: 14
    -size: 6
    -requirement: WIRE-JOIN-REQUEST
    seq:
      - id: seq_num
        type: u2
        doc: Of this request.
      - id: mote_desc
        type: mote_desc
        doc: Of the mote that asks.

  join_reply:
    doc: A sink offers a place in its island.
    doc-ref: "paper: Component Management"
    -am-type: 15
    -size: 10
    -requirement: WIRE-JOIN-REPLY
    seq:
      - id: island_addr
        type: u2
        doc: The sink's island.
      - id: mote_addr
        type: u2
        doc: The mote's devid from now on.
      - id: cur_time
        type: u4
        doc: The sink's clock.
        -unit: {symbol: ms}
      - id: seq_num
        type: u2
        doc: Of the request that it answers.

  ack_join:
    doc: A mote takes the offer.
    doc-ref: "paper: Component Management"
    -am-type: 29
    -size: 14
    -requirement: WIRE-ACK-JOIN
    seq:
      - id: dest
        type: r_addr
        doc: The sink.
      - id: src
        type: r_addr
        doc: The mote, by its new address.
      - id: seq_num
        type: u2
        doc: Of the reply that it takes.
      - id: mote_desc
        type: mote_desc
        doc: Of the mote.

  serial_joined:
    doc: A sink tells its base station of a new mote.
    doc-ref: "paper: Component Management; release 1.0"
    -am-type: 16
    -size: 9
    -requirement: WIRE-SERIAL-JOINED
    seq:
      - id: msg_type
        type: u1
        enum: am_type
        -expect: am_type::serial_joined
        doc: Kind of the body.
      - id: island_addr
        type: u2
        doc: The island.
      - id: mote_addr
        type: u2
        doc: The mote's devid.
      - id: mote_type
        type: u1
        enum: mote_type
        doc: Platform.
      - id: transducers
        type: transducer_mask
        doc: Sensors on board.
      - id: actuators
        type: actuator_mask
        doc: Actuators on board.

  config:
    doc: The base station sets up its sink.
    doc-ref: release 1.0
    -am-type: 37
    -size: 3
    -requirement: WIRE-CONFIG
    seq:
      - id: type
        type: u1
        enum: command_code
        doc: What to set.
      - id: value
        type: u2
        doc: To what; for set_island_id the island.

  # Readings of sensors.

  command:
    doc: A request for readings, of older tools.
    doc-ref: release 1.0
    -am-type: 11
    -size: 5
    -requirement: WIRE-COMMAND
    seq:
      - id: type
        type: u1
        enum: command_code
        doc: What is asked for.
      - id: counter
        type: u2
        doc: Number of the request.
      - id: delay
        type: u2
        doc: Delay of the answer.
        -unit: {symbol: ms}

  data:
    doc: Readings of a mote, of older tools.
    doc-ref: release 1.0
    -am-type: 10
    -size: 10
    -requirement: WIRE-DATA
    seq:
      - &counter
        id: counter
        type: u2
        doc: Number of the request.
      - &temp
        id: temp
        type: u2
        doc: Temperature, raw; on telosb 0.01 degrees Celsius above -40.
        -unit: {symbol: degC, scale: 0.01, offset: -40}
      - &humid
        id: humid
        type: u2
        doc: Humidity, raw.
      - &light
        id: light
        type: u2
        doc: Light, raw.
      - &rssi
        id: rssi
        type: u2
        doc: Signal strength, raw.

  serial_data:
    doc: Readings of a mote, forwarded by its sink, of older tools.
    doc-ref: release 1.0
    -am-type: 12
    -size: 13
    -requirement: WIRE-SERIAL-DATA
    seq:
      - id: src_island_addr
        type: u1
        doc: The mote's island.
      - id: src_mote_addr
        type: u2
        doc: The mote's devid.
      - *counter
      - *temp
      - *humid
      - *light
      - *rssi

  demo:
    doc: Starts periodic readings of the demo.
    doc-ref: release 1.0
    -am-type: 32
    -size: 5
    -requirement: WIRE-DEMO
    seq:
      - id: msg_type
        type: u1
        -expect: 1
        doc: Kind of the body; 1, not 32.
      - id: sensors_bitmask
        type: transducer_mask
        doc: What to read.
      - id: period
        type: u2
        doc: How often.
        -unit: {symbol: ms}

  complete:
    doc: A whole network message with a demo command in it.
    doc-ref: release 1.0
    -am-type: 33
    -size: 19
    -requirement: WIRE-COMPLETE
    seq:
      - id: dest
        type: r_addr
        doc: To whom.
      - id: src
        type: r_addr
        doc: From whom.
      - id: reliable
        type: u1
        valid:
          max: 1
        doc: 1 asks for a RUBICON acknowledgement.
        -requirement: WIRE-NET-RELIABLE
      - id: seq_num
        type: u2
        doc: Sequence number.
      - id: nbytes
        type: u1
        valid:
          min: 2
          max: 102
        doc: Bytes after the header.
        -requirement: WIRE-NET-NBYTES
      - id: trans_id
        type: u1
        enum: component
        doc: Transport component.
      - id: app_id
        type: u1
        enum: component
        doc: Application component.
      - id: payload
        type: demo
        doc: The command.

  demo_data:
    doc: Periodic readings of the demo.
    doc-ref: release 1.0
    -am-type: 34
    -size: 19
    -requirement: WIRE-DEMO-DATA
    seq:
      - id: msg_type
        type: u1
        enum: am_type
        -expect: am_type::demo_data
        doc: Kind of the body.
      - id: light
        type: u2
        doc: Light, raw.
      - id: temp
        type: u2
        doc: Temperature, raw; on telosb 0.01 degrees Celsius above -40.
        -unit: {symbol: degC, scale: 0.01, offset: -40}
      - id: accx
        type: u2
        doc: Acceleration along x, raw.
      - id: accy
        type: u2
        doc: Acceleration along y, raw.
      - id: pir
        type: u2
        doc: Movement.
      - id: mic
        type: u2
        doc: Sound level, raw.
      - id: humid
        type: u2
        doc: Humidity, raw.
      - id: magnetic
        type: u2
        doc: Magnetic switch.
      - id: my_rssi
        type: u2
        doc: Signal strength, raw.

  transducer_update:
    doc: A transducer and its value.
    -size: 4
    -requirement: WIRE-UPDATES
    seq:
      - id: transducer
        type: transducer_mask
        doc: Which one, by its bit.
      - id: value
        type: u2
        doc: Raw reading.

  updates:
    doc: Readings of a mote, as pairs of transducer and value.
    doc-ref: "paper: In-Hospital Transport Test-Bed; release 1.0"
    -am-type: 35
    -size: 98
    -requirement: WIRE-UPDATES
    seq:
      - id: type
        type: u1
        enum: am_type
        -expect: am_type::updates
        doc: Kind of the body.
      - id: output_size
        type: u1
        valid:
          max: 24
        doc: Number of pairs.
      - id: updates
        type: transducer_update
        repeat: expr
        repeat-expr: output_size
        doc: The pairs.

  read_updates:
    doc: Asks a mote for periodic updates.
    doc-ref: release 1.0
    -am-type: 36
    -size: 5
    -requirement: WIRE-READ-UPDATES
    seq:
      - id: type
        type: u1
        enum: am_type
        -expect: am_type::read_updates
        doc: Kind of the body.
      - id: sampling_rate
        type: u2
        doc: Period of the readings.
        -unit: {symbol: ms}
      - id: transducers
        type: transducer_mask
        doc: What to read.

  rssi_beacon:
    doc: Beacon of an anchor for localisation.
    doc-ref: "paper: In-Hospital Transport Test-Bed; release 1.0"
    -am-type: 6
    -size: 1
    -requirement: WIRE-RSSI-BEACON
    seq:
      - id: anchor_id
        type: u1
        doc: The anchor.

  # Learning layer.

  netid_cmd:
    doc: A command for one learning module.
    doc-ref: release 1.0
    -am-type: 17
    -size: 5
    -requirement: WIRE-NETID-CMD
    seq:
      - id: type
        type: u1
        enum: learning_code
        doc: What to do.
      - id: net_id
        type: u2
        doc: The learning module.
      - id: seq_num
        type: u2
        doc: Of this command.

  broadcast_cmd:
    doc: Sets the clock of the learning network.
    doc-ref: release 1.0
    -am-type: 18
    -size: 5
    -requirement: WIRE-BROADCAST-CMD
    seq:
      - id: type
        type: u1
        enum: learning_code
        doc: What to do.
      - id: clock
        type: u2
        doc: Period of the clock.
        -unit: {symbol: ms}
      - id: seq_num
        type: u2
        doc: Of this command.

  syn_create_cmd:
    doc: Creates a synaptic connection.
    doc-ref: "paper: Synaptic Communication; release 1.0"
    -am-type: 19
    -size: 58
    -requirement: WIRE-SYN-CREATE-CMD
    seq:
      - id: type
        type: u1
        enum: learning_code
        doc: Outgoing, incoming or local.
      - id: src_island_addr
        type: u2
        doc: Island of the source.
      - id: src_mote_addr
        type: u2
        doc: Mote of the source.
      - id: dest_island_addr
        type: u2
        doc: Island of the destination.
      - id: dest_mote_addr
        type: u2
        doc: Mote of the destination.
      - id: src_net_id
        type: u2
        doc: Learning module of the source.
      - id: dest_net_id
        type: u2
        doc: Learning module of the destination.
      - id: src_neurons_size
        type: u1
        valid:
          max: 10
        doc: Used entries of src_neurons.
      - id: src_neurons
        type: u2
        repeat: expr
        repeat-expr: 10
        doc: Neurons of the source; always whole.
      - id: dest_neurons_size
        type: u1
        valid:
          max: 10
        doc: Used entries of dest_neurons.
      - id: dest_neurons
        type: u2
        repeat: expr
        repeat-expr: 10
        doc: Neurons of the destination; always whole.
      - id: params
        type: s1
        doc: Options of the channel.
      - id: seq_num
        type: u2
        doc: Of this command.

  learning_module_cmd:
    doc: Weights of a learning module, four bits each, two in a byte.
    doc-ref: release 1.0
    -am-type: 20
    -size: 100
    -requirement: WIRE-LEARNING-MODULE-CMD
    seq:
      - id: type
        type: u1
        enum: learning_code
        doc: Which matrix.
      - id: net_id
        type: u2
        doc: The learning module.
      - id: seq_num
        type: u2
        doc: Of this command.
      - id: rows
        type: u1
        doc: Rows of the matrix.
      - id: cols
        type: u1
        doc: Columns of the matrix.
      - id: matrix_size
        type: u1
        valid:
          max: 92
        doc: Bytes of weights.
      - id: weights
        type: u1
        repeat: expr
        repeat-expr: matrix_size
        doc: Weights, two in a byte.

  learning_module_float_cmd:
    doc: Weights of a learning module as floats.
    doc-ref: release 1.0
    -am-type: 21
    -size: 100
    -requirement: WIRE-LEARNING-MODULE-FLOAT-CMD
    seq:
      - id: type
        type: u1
        enum: learning_code
        doc: Which matrix.
      - id: net_id
        type: u2
        doc: The learning module.
      - id: seq_num
        type: u2
        doc: Of this command.
      - id: rows
        type: u1
        doc: Rows of the matrix.
      - id: cols
        type: u1
        doc: Columns of the matrix.
      - id: matrix_size
        type: u1
        valid:
          max: 23
        doc: Number of weights.
      - id: weights
        type: f4le
        repeat: expr
        repeat-expr: matrix_size
        doc: Weights.

  learning_notification:
    doc: A learning module answers a command.
    doc-ref: release 1.0
    -am-type: 23
    -size: 4
    -requirement: WIRE-LEARNING-NOTIFICATION
    seq:
      - id: type
        type: u1
        enum: am_type
        -expect: am_type::learning_notification
        doc: Kind of the body.
      - id: seq_num
        type: u2
        doc: Of the command.
      - id: ack
        type: u1
        doc: 0 is success.

  learning_module_down:
    doc: Weights of a learning module, to the PC.
    doc-ref: release 1.0
    -am-type: 24
    -size: 96
    -requirement: WIRE-LEARNING-MODULE-DOWN
    seq:
      - id: type
        type: u1
        enum: am_type
        -expect: am_type::learning_module_down
        doc: Kind of the body.
      - id: net_id
        type: u2
        doc: The learning module.
      - id: matrix_size
        type: u1
        valid:
          max: 23
        doc: Number of weights.
      - id: weights
        type: f4le
        repeat: expr
        repeat-expr: matrix_size
        doc: Weights.

  learning_output:
    doc: Output of a learning module, to the PC.
    doc-ref: release 1.0
    -am-type: 25
    -size: 98
    -requirement: WIRE-LEARNING-OUTPUT
    seq:
      - id: type
        type: u1
        enum: am_type
        -expect: am_type::learning_output
        doc: Kind of the body.
      - id: output_size
        type: u1
        valid:
          max: 24
        doc: Number of values.
      - id: output
        type: f4le
        repeat: expr
        repeat-expr: output_size
        doc: Values.

  # Obsolete, kept because old tools still carry them.

  net_command:
    doc: Obsolete network message with a command.
    doc-ref: release 1.0
    -size: 4
    -requirement: WIRE-NET-COMMAND
    seq:
      - id: src_island_addr
        type: u1
        doc: Island of the source.
      - id: src_mote_addr
        type: u2
        doc: Mote of the source.
      - id: type
        type: u1
        enum: command_code
        doc: What is asked for.

  net_data:
    doc: Obsolete network message with readings.
    doc-ref: release 1.0
    -size: 15
    -requirement: WIRE-NET-DATA
    seq:
      - id: src_island_addr
        type: u1
        doc: Island of the source.
      - id: src_mote_addr
        type: u2
        doc: Mote of the source.
      - id: id
        type: u2
        doc: Mote id.
      - *counter
      - *temp
      - *humid
      - *light
      - *rssi

  connless:
    doc: Obsolete transport message.
    doc-ref: release 1.0
    -am-type: 27
    -size: 108
    -requirement: WIRE-CONNLESS
    seq:
      - id: msg_type
        type: u1
        enum: am_type
        doc: Kind of the payload.
      - id: island_addr
        type: u1
        doc: Island.
      - id: mote_addr
        type: u2
        doc: Mote.
      - id: reliable
        type: u1
        valid:
          max: 1
        doc: 1 asks for an acknowledgement.
      - id: seq_num
        type: u2
        doc: Sequence number.
      - id: nbytes
        type: u1
        valid:
          max: 100
        doc: Bytes of the payload.
      - id: payload
        size: nbytes
        doc: The application's bytes.

enums:
  am_type:
    1: serialtemp
    2: serialhumid
    3: seriallight
    4: serialrssi
    5: serialdata
    6: temp
    7: humid
    8: light
    9: rssi
    10: data
    11: command
    12: serial_data
    13: syn_data
    14: join
    15: join_reply
    16: serial_joined
    17: netid_cmd
    18: broadcast_cmd
    19: syn_create_cmd
    20: learning_module_cmd
    21: learning_module_float_cmd
    22: packetized_matrix
    23: learning_notification
    24: learning_module_down
    25: learning_output
    26: serial_output
    27: connless
    28: net
    29: ack_join
    30: app
    31: r_addr
    32: demo
    33: complete
    34: demo_data
    35: updates
    36: read_updates
    37: config
  component:
    1: syn_channel
    2: stream
    3: connless
    4: comp_mngmnt
    5: mockup
    6: learning
    7: transport_md
    8: application_md
    9: rubicon_ack
    10: control_layer
    11: esn_data
  command_code:
    1: read_temp
    2: read_humid
    3: read_light
    4: read_rssi
    5: read_data
    6: read_data_random_wait
    7: read_log
    8: read_periodically
    9: demo_syn
    10: set_island_id
  learning_code:
    1: activate_forw_comp
    2: stop_forw_comp
    3: activate_learn_module
    4: stop_learn_module
    5: reset_learn_module
    6: connect_node
    7: disconnect_node
    8: set_clock
    9: syn_conn_out
    10: syn_conn_in
    11: syn_conn_local
    12: upload_module_win
    13: download_module_win
    14: activate_feat_sel
    15: stop_feat_sel
    16: upload_module_wa
    17: download_module_wa
    18: upload_module_wb
    19: download_module_wb
    20: upload_module_wout
    21: download_module_wout
    22: upload_scaling_constants
    23: online_event
    24: online_noevent
    25: online_incr_feedback
    26: online_decr_feedback
    27: stop_online
    28: upload_module_esnparams
  mote_type:
    1: telosb_demo
    2: iris_demo
    3: micaz_demo
  pid:
    0xffff: broadcast
    0xfffe: local
    0xfffd: proxy
  devid:
    0xffff: broadcast
    0xfffe: local
    0xfffd: 'null'
