# expect: 4:11: endian is 'middle'; be or le was expected
meta:
  id: bad
  endian: middle
