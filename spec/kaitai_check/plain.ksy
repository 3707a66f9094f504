# What a plain Kaitai file has beyond the strict profile: run_time_check.js compares the reading of it.
meta:
  id: plain
  endian: be
  encoding: UTF-8
seq:
  - id: version
    type: b4
  - id: flag
    type: b1
  - id: wide
    type: b19
  - id: length
    type: u1
  - id: padded
    type: str
    size: length % 16
    pad-right: 32
  - id: name
    type: str
    size: 8
    terminator: 0
    encoding: ASCII
  - id: label
    type: strz
  - id: amount
    type: u1
  - id: amounts
    type: u2
    repeat: expr
    repeat-expr: amount
  - id: bytes
    terminator: 10
    eos-error: false
  - id: number
    type: u2
    if: flag
  - id: nested
    type: outer
    if: version > 3
  - id: chosen
    type:
      switch-on: version
      cases:
        1: items
        2: outer
  - id: list
    type: items
    repeat: expr
    repeat-expr: length % 3
  - id: less
    size: length - 1
    if: version == 5
  - id: tail
    type: str
    size-eos: true
types:
  outer:
    seq:
      - id: kind
        type: b3
        enum: kind
      - id: rest
        type: b13
      - id: part
        type: inner
    types:
      inner:
        seq:
          - id: value
            type: s2le
    enums:
      kind:
        1: one
        2: two
  items:
    seq:
      - id: count
        type: u1
      - id: values
        type: u2
        repeat: expr
        repeat-expr: count % 5
