// Expressions of the reflection tables.
#include "codec/reflect/decode.h"

namespace rubric::reflect {
namespace {

RUBRIC_INLINE std::int64_t load_step(const ExprStep& step, Bytes structure) {
  const auto at = static_cast<std::size_t>(step.value);
  const std::uint8_t* p = structure.data() + at;
  const std::size_t size = structure.size();
  switch (step.op) {
    case Op::kLoadU8: return at + 1 <= size ? load_u8(p) : 0;
    case Op::kLoadBe16: return at + 2 <= size ? load_be16(p) : 0;
    case Op::kLoadLe16: return at + 2 <= size ? load_le16(p) : 0;
    case Op::kLoadBe32: return at + 4 <= size ? load_be32(p) : 0;
    default: return at + 4 <= size ? load_le32(p) : 0;
  }
}

// Division as Kaitai Struct defines it: towards negative infinity.
std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  if (b == 0) return 0;
  const std::int64_t q = a / b;
  return q - ((a % b != 0) && ((a < 0) != (b < 0)));
}

std::int64_t apply(Op op, std::int64_t a, std::int64_t b) {
  switch (op) {
    case Op::kAdd: return a + b;
    case Op::kSub: return a - b;
    case Op::kMul: return a * b;
    case Op::kDiv: return floor_div(a, b);
    case Op::kMod: return b == 0 ? 0 : a - floor_div(a, b) * b;
    case Op::kEq: return a == b;
    case Op::kNe: return a != b;
    case Op::kLt: return a < b;
    case Op::kLe: return a <= b;
    case Op::kGt: return a > b;
    case Op::kGe: return a >= b;
    case Op::kAnd: return a && b;
    case Op::kOr: return a || b;
    case Op::kBitAnd: return a & b;
    case Op::kBitOr: return a | b;
    case Op::kBitXor: return a ^ b;
    case Op::kShiftLeft:
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) << (b & 63));
    case Op::kShiftRight: return a >> (b & 63);
    default: return 0;
  }
}

Op step_of(const Expr& expr, int i) { return expr.steps[i].op; }

}  // namespace

std::int64_t evaluate(const Expr& expr, Bytes structure, const std::int64_t* params) {
  if (expr.count == 1 && expr.steps[0].op <= Op::kLoadLe32) {  // By far the most frequent: a load.
    const ExprStep& only = expr.steps[0];
    return only.op == Op::kConst ? only.value : load_step(only, structure);
  }
  std::int64_t stack[kMaxExprDepth];
  int top = 0;
  for (int i = 0; i < expr.count; ++i) {
    const ExprStep& step = expr.steps[i];
    if (step.op == Op::kConst) {
      stack[top++] = step.value;
    } else if (step.op <= Op::kLoadLe32) {
      std::int64_t value = load_step(step, structure);
      // Most conditions are "field == constant".
      if (i + 2 < expr.count && step_of(expr, i + 1) == Op::kConst &&
          step_of(expr, i + 2) == Op::kEq) {
        value = value == expr.steps[i + 1].value;
        i += 2;
      }
      stack[top++] = value;
    } else if (step.op == Op::kParam) {
      stack[top++] = params ? params[step.value] : 0;
    } else if (step.op == Op::kNot) {
      stack[top - 1] = !stack[top - 1];
    } else if (step.op == Op::kSelect) {
      top -= 2;
      stack[top - 1] = stack[top - 1] ? stack[top] : stack[top + 1];
    } else {
      --top;
      stack[top - 1] = apply(step.op, stack[top - 1], stack[top]);
    }
  }
  return stack[0];
}

}  // namespace rubric::reflect
