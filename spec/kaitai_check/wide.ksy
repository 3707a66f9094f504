# Numbers of 64 bits: run_time_check.js compares the reading of them, install_wireshark_test.py what
# Wireshark shows.
meta:
  id: wide
  endian: be
seq:
  - id: big
    type: u8
  - id: little
    type: u8le
  - id: below
    type: s8
  - id: kind
    type: u8
    enum: kind
  - id: count
    type: u1
  - id: counted
    type: s8le
    repeat: expr
    repeat-expr: count % 3
  - id: few
    type: u8le
    valid:
      max: 1000
    if: count > 200
  - id: many
    type: u8
    valid:
      min: 9007199254740991
    if: count > 230
  - id: tail
    type: u8
    repeat: eos
enums:
  kind:
    0: none
    4294967295: all
