# expect: 7:1: unknown key 'to-string' of a spec; it is Kaitai Struct's, and is not read
# expect: 8:1: unknown key 'colour' of a spec; known are meta, doc, doc-ref, params, seq, types,
#   enums, instances, -name, -size, -am-type, -carrier, ...
meta:
  id: bad
  endian: be
to-string: a
colour: 1
