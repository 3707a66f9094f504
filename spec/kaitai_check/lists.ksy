# Parameters, lists up to a condition, and text of other encodings, beyond what plain.ksy has:
# run_time_check.js compares the reading of them.
meta:
  id: lists
  endian: be
  encoding: ISO-8859-15
seq:
  - id: length
    type: u1
  - id: flag
    type: u1
  - id: head
    type: part(length % 7, flag == 1, 2)
  - id: numbers
    type: u1
    repeat: until
    repeat-until: _ == 0
  - id: labels
    type: label
    repeat: until
    repeat-until: _.size == 0 or _.size >= 192
  - id: named
    type: behind
    repeat: until
    repeat-until: _.last == 0
  - id: wide
    type: strz
    encoding: UTF-16LE
  - id: chosen
    type:
      switch-on: flag
      cases:
        1: part(length, true, 1)
        _: part(2, false, 3)
  - id: parts
    type: part(1, flag > 1, length % 3)
    repeat: expr
    repeat-expr: 2
  - id: latin
    type: str
    size: 4
    encoding: windows-1252
  - id: tail
    type: str
    size-eos: true
types:
  part:
    params:
      - id: size
        type: u1
      - id: more
        type: bool
      - id: count
        type: u2
    seq:
      - id: bytes
        size: size
      - id: extra
        type: u2
        if: more
      - id: list
        type: u1
        repeat: expr
        repeat-expr: count
      - id: inner
        type: twice(size)
  twice:
    params:
      - id: size
        type: u1
    seq:
      - id: rest
        size: size * 2
  label:
    seq:
      - id: size
        type: u1
      - id: text
        type: str
        size: size % 4
  behind:
    seq:
      - id: name
        type: strz
      - id: last
        type: u1
