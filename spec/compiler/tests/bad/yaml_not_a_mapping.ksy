# expect: 2:1: not a spec; a mapping with meta: was expected
- meta
