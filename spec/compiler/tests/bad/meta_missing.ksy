# expect: 2:1: no meta; a spec begins with meta: and its id
types: {}
