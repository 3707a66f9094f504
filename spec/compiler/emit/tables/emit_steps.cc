// Prints expressions as steps in postfix order, and names of the reflection enums.
#include "spec/compiler/emit/tables/emit_steps.h"

#include <stdexcept>

#include "spec/compiler/emit/cpp_text.h"

namespace rubricc {
namespace {

std::string load(const Field& field) {
  if (field.width_bytes == 1) return "Op::kLoadU8";
  const std::string order = field.little_endian ? "Le" : "Be";
  return "Op::kLoad" + order + (field.width_bytes == 2 ? "16" : "32");
}

std::string op_name(ExprOp op) {
  switch (op) {
    case ExprOp::kInt:
    case ExprOp::kEnumValue: return "Op::kConst";
    case ExprOp::kAdd: return "Op::kAdd";
    case ExprOp::kSub: return "Op::kSub";
    case ExprOp::kMul: return "Op::kMul";
    case ExprOp::kDiv: return "Op::kDiv";
    case ExprOp::kMod: return "Op::kMod";
    case ExprOp::kEq: return "Op::kEq";
    case ExprOp::kNe: return "Op::kNe";
    case ExprOp::kLt: return "Op::kLt";
    case ExprOp::kLe: return "Op::kLe";
    case ExprOp::kGt: return "Op::kGt";
    case ExprOp::kGe: return "Op::kGe";
    case ExprOp::kAnd: return "Op::kAnd";
    case ExprOp::kOr: return "Op::kOr";
    case ExprOp::kNot: return "Op::kNot";
    case ExprOp::kField: break;
  }
  throw std::logic_error("op_name: a field has no operator");
}

void append(const Expr& expr, std::vector<Step>& out) {
  for (const auto& operand : expr.operands) append(*operand, out);
  if (expr.op == ExprOp::kField) {
    out.push_back({load(*expr.field), expr.offset_bytes});
  } else {
    out.push_back({op_name(expr.op), expr.value});
  }
}

}  // namespace

std::vector<Step> postfix(const Expr& expr) {
  std::vector<Step> out;
  append(expr, out);
  return out;
}

std::string kind_name(ValueKind kind) {
  switch (kind) {
    case ValueKind::kUint: return "Kind::kUint";
    case ValueKind::kSint: return "Kind::kSint";
    case ValueKind::kFloat: return "Kind::kFloat";
    case ValueKind::kMask: return "Kind::kMask";
    case ValueKind::kBytes: return "Kind::kBytes";
    case ValueKind::kStruct: return "Kind::kStruct";
  }
  throw std::logic_error("kind_name");
}

std::string repeat_name(RepeatKind repeat) {
  switch (repeat) {
    case RepeatKind::kOnce: return "Repeat::kOnce";
    case RepeatKind::kCount: return "Repeat::kCount";
    case RepeatKind::kToEnd: return "Repeat::kToEnd";
  }
  throw std::logic_error("repeat_name");
}

std::string extent_name(ExtentKind extent) {
  switch (extent) {
    case ExtentKind::kOwn: return "Extent::kOwn";
    case ExtentKind::kSize: return "Extent::kSize";
    case ExtentKind::kToEnd: return "Extent::kToEnd";
  }
  throw std::logic_error("extent_name");
}

}  // namespace rubricc
