# Instances that are computed, operators on bits, and fields that may be absent: run_time_check.js
# compares the reading of them. Kaitai's JavaScript lacks brackets around a count that is `a & b`.
meta:
  id: computed
  endian: be
seq:
  - id: first
    type: u1
  - id: total
    type: u1
  - id: flags
    type: flag_set
  - id: options
    size: header_bytes - 4
  - id: body
    size: total % 32 - header_bytes
    type:
      switch-on: kind
      cases:
        'kind::words': words
        'kind::text': text
  - id: extra
    type: u1
    if: flags.has_extra
  - id: after
    size: 'flags.has_extra ? extra % 4 : 1'
  - id: repeated
    type: u1
    repeat: expr
    repeat-expr: (extra & 0b0000_0011) + 1
    if: flags.has_extra
  - id: parts
    type: part
    repeat: until
    repeat-until: _.is_last
  - id: mixed
    size: (first ^ total) & 3 | 4
  - id: singles
    size: 1
    repeat: expr
    repeat-expr: version % 4
  - id: tail
    size-eos: true
instances:
  version:
    value: (first & 0xf0) >> 4
  header_bytes:
    value: (first & 0x3) * 4
  kind:
    value: version & 3
    enum: kind
types:
  flag_set:
    seq:
      - id: raw
        type: u1
    instances:
      has_extra:
        value: raw & 0x81 == 0x81 or raw < 3
  words:
    seq:
      - id: list
        type: u2
        repeat: eos
  text:
    seq:
      - id: text
        type: str
        encoding: ASCII
        size-eos: true
  part:
    seq:
      - id: head
        type: u1
      - id: content
        size: 'length > 2 ? length - 2 : length << 1'
    instances:
      length:
        value: (head & 0x1c) >> 2
      is_last:
        value: head >= 0x80
enums:
  kind:
    1: words
    2: text
