meta:
  id: bad
  endian: be
types:
  and_of_numbers:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 31: 'n' does not fit here; a comparison was expected
      - {id: b, type: u1, if: n and n == 1}
  constant_too_large:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u4}
      # expect: 36: 2147483648 is beyond 32 bits; constants of expressions are signed 32-bit
      #   numbers
      - {id: b, type: u1, if: n == 0x80000000}
  division_by_zero:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 27: 'n' can be zero; a divisor that is never zero was expected
      - {id: b, size: 100 / n}
  expression_stack:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 25: the expression is too deep to evaluate; at most 8 values are kept
      - {id: b, size: n + (n + (n + (n + (n + (n + (n + (n + (n + 1))))))))}
  expression_syntax:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      # expect: 26: the expression ends early; a number, a field or an enum::value was expected
      - {id: b, size: n +}
      # expect: 29: a bracket is not closed; ')' was expected
      - {id: c, size: (n + 1}
      # expect: 25: unexpected 'n'; an operator or the end of the expression was expected
      - {id: d, size: n n}
      # expect: 25: '&' is outside the profile; + - * / %, comparisons, and, or, not were
      #   expected
      - {id: e, size: n & 3}
      # expect: 23: '_parent' is outside the profile; fields of the same structure can be read
      - {id: f, size: _parent.n}
      # expect: 24: the expression ends early; a number, a field or an enum::value was expected
      - {id: g, size: ''}
  expression_too_deep:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - id: b
        size:
          # expect: 52: the expression nests too deep; write it simpler
          ((((((((((((((((((((((((((((((((((((((((((((((((((n
          ))))))))))))))))))))))))))))))))))))))))))))))))))
  expression_too_long:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - id: b
        size:
          # expect: 11: the expression is too long; at most 1000 characters are read
          n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
          + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n + n
  field_at_no_constant_position:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1}
      - {id: a, size: n}
      - {id: m, type: u1}
      # expect: 23: 'm' is at no constant position; what comes before it must have a constant
      #   size
      - {id: b, size: m}
  field_is_a_list:
    -requirement: WIRE-DATA
    seq:
      - {id: n, type: u1, repeat: expr, repeat-expr: 2}
      # expect: 23: 'n' is a list; a single number was expected
      - {id: b, size: n}
