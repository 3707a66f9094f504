# A spec without types, to read requirements with.
meta:
  id: none
