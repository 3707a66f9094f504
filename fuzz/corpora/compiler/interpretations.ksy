meta: {id: interpretations, endian: be}
types:
  demo:
    -requirement: WIRE-DATA
    seq: [{id: x, type: u1}, {id: y, type: u2}]
  message:
    -requirement: WIRE-DATA
    -size: 100
    seq:
      - {id: from, type: u1}
      - {id: payload, size-eos: true}
    instances:
      first: {pos: 1, type: u1}
      body:
        -name: body
        if: not (from == 0 or from >= 3)
        pos: 1
        size-eos: true
        type:
          switch-on: first
          cases: {1: demo, _: demo}
