# What no wire spec has yet: names that Java keeps for itself, and sizes that must be computed.
meta:
  id: odd
  title: Odd things
  endian: be
doc: Not a protocol.
types:
  string:
    doc: A path such as C:\users and the end of a comment, */, hurt nobody.
    -requirement: WIRE-APP-HEADER
    seq:
      - {id: byte, type: u1, doc: Named like a type.}
      - {id: get_class, type: u1, doc: Named like a method of every object.}
      - {id: import, type: u1, doc: Named like a word of the language.}
      - {id: size_bytes_2, type: u1, doc: Almost the name of a method.}
  writer:
    -requirement: WIRE-APP-HEADER
    seq:
      - {id: value, type: s2le, valid: {min: -5, max: 300}}
      - {id: count, type: u1, valid: {max: 7}}
      - {id: flags, type: u4, if: count / 2 == 1 and not (count % 2 == 0)}
      - {id: out, type: string}
      - {id: in, type: s1, repeat: expr, repeat-expr: (7 - count) * 2 + 1, valid: {any-of: [-1, 2]}}
      - {id: rest, type: f4, repeat: eos}
  tail:
    -requirement: WIRE-APP-HEADER
    -size: 13
    seq:
      - {id: size, type: u1, valid: {min: 2, max: 6}}
      - {id: pairs, type: string, repeat: expr, repeat-expr: size / 2}
