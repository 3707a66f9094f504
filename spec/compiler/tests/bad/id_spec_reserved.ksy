# expect: 4:7: 'reflect' cannot be the name of a spec; the generated code has a namespace of that
#   name
meta:
  id: reflect
  endian: be
