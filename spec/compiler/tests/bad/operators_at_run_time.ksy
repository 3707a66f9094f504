# expect: 24:17: '&' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 26:17: '<<' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 26:17: 'w << 8' can be beyond 32 bits; operators on bits take and make 0 to 4294967295
# expect: 28:22: '? :' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 28:22: 'a > 3 ? a : k' has values of two kinds; two numbers, or two values of one enum
#   were expected
# expect: 30:16: 'a' does not fit here; a condition was expected
# expect: 30:18: '? :' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 32:22: '? :' is outside the profile; + - * / %, comparisons, and, or, not were expected
# expect: 32:25: a choice without ':'; a ? b : c was expected
meta:
  id: bad
  endian: be
enums:
  kind: {1: one}
types:
  one:
    -requirement: WIRE-DATA
    seq:
      - {id: a, type: u1}
      - {id: k, type: u1, enum: kind}
      - {id: w, type: u4}
      - id: masked
        size: a & 0x0f
      - id: shifted
        size: w << 8
      - id: chosen
        size: 'a > 3 ? a : k'
      - id: number
        size: 'a ? 1 : 2'
      - id: half
        size: 'a > 3 ? 1'
