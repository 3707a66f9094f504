# expect: 6:1: unknown key 'params' of a spec; known are meta, doc, doc-ref, seq, types, enums,
#   instances, -name, -size, -am-type, -carrier, -requirement
meta:
  id: bad
  endian: be
params: []
