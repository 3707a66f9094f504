# expect: 7:1: unknown key 'params' of a spec; it is Kaitai Struct's, and is not read
# expect: 8:1: unknown key 'colour' of a spec; known are meta, doc, doc-ref, seq, types, enums,
#   instances, -name, -size, -am-type, -carrier, -requirement
meta:
  id: bad
  endian: be
params: []
colour: 1
