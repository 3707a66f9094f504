// Property: the steps of an expression give the value of its tree, evaluated plainly, whatever the
// bytes, even where it reads beyond their end.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/reflect/decode.h"
#include "fuzz/support/input.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using reflect::ExprStep;
using reflect::Op;

// The value of a tree, and how far from 0 a tree of that form can be: rubricc makes sure that no
// expression of a spec overflows.
struct Meaning {
  std::int64_t value;
  std::int64_t most;
};

constexpr std::int64_t kMost = std::int64_t{1} << 62;
// One value more waits on the stack at each level.
constexpr int kDepthMax = reflect::kMaxExprDepth - 1;

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  if (b < 0) return floor_div(-a, -b);
  return b == 0 ? 0 : (a - (a % b + b) % b) / b;
}

std::int64_t meaning(Op op, std::int64_t a, std::int64_t b) {
  switch (op) {
    case Op::kAdd: return a + b;
    case Op::kSub: return a - b;
    case Op::kMul: return a * b;
    case Op::kDiv: return floor_div(a, b);
    case Op::kMod: return b == 0 ? 0 : a - b * floor_div(a, b);
    case Op::kEq: return a == b;
    case Op::kNe: return a != b;
    case Op::kLt: return a < b;
    case Op::kLe: return a <= b;
    case Op::kGt: return a > b;
    case Op::kGe: return a >= b;
    case Op::kAnd: return a != 0 && b != 0;
    case Op::kBitAnd: return a & b;
    case Op::kBitOr: return a + b - (a & b);
    case Op::kBitXor: return a + b - 2 * (a & b);
    default: return a != 0 || b != 0;
  }
}

Meaning number(fuzz::Input& input, Bytes structure, std::vector<ExprStep>& steps) {
  constexpr std::array kLoads = {Op::kLoadU8, Op::kLoadBe16, Op::kLoadLe16, Op::kLoadBe32,
                                 Op::kLoadLe32};
  const std::size_t which = input.below(kLoads.size() + 1);
  if (which == kLoads.size()) {
    const auto value = static_cast<std::int32_t>(input.u32());
    steps.push_back({Op::kConst, value});
    return {value, std::int64_t{1} << 31};
  }
  const Op op = kLoads[which];
  const std::size_t at = input.below(structure.size() + 4);
  const std::size_t width = op == Op::kLoadU8 ? 1 : op <= Op::kLoadLe16 ? 2 : 4;
  const bool little = op == Op::kLoadLe16 || op == Op::kLoadLe32;
  std::int64_t value = 0;
  for (std::size_t i = 0; i < width && at + width <= structure.size(); ++i) {
    value = value << 8 | structure[at + (little ? width - 1 - i : i)];
  }
  steps.push_back({op, static_cast<std::int32_t>(at)});
  return {value, std::int64_t{1} << 32};
}

Meaning tree(fuzz::Input& input, Bytes structure, int depth, std::vector<ExprStep>& steps) {
  constexpr std::array kOps = {Op::kAdd, Op::kSub,    Op::kMul,   Op::kDiv,   Op::kMod, Op::kEq,
                               Op::kNe,  Op::kLt,     Op::kLe,    Op::kGt,    Op::kGe,  Op::kAnd,
                               Op::kOr,  Op::kBitAnd, Op::kBitOr, Op::kBitXor};
  const std::size_t which = depth == 0 ? 0 : input.below(kOps.size() + 3);
  if (which == 0) return number(input, structure, steps);
  if (which == kOps.size() + 2 && depth >= 2) {  // Two values wait for the third.
    const Meaning condition = tree(input, structure, depth - 2, steps);
    const Meaning yes = tree(input, structure, depth - 2, steps);
    const Meaning no = tree(input, structure, depth - 2, steps);
    steps.push_back({Op::kSelect, 0});
    return {condition.value != 0 ? yes.value : no.value, std::max(yes.most, no.most)};
  }
  const Meaning a = tree(input, structure, depth - 1, steps);
  if (which == 1 || which == kOps.size() + 2) {
    steps.push_back({Op::kNot, 0});
    return {a.value == 0, 1};
  }
  const Meaning b = tree(input, structure, depth - 1, steps);
  Op op = kOps[which - 2];
  if (op == Op::kMul && a.most > kMost / b.most) op = Op::kLt;
  const bool adds = op <= Op::kSub || op >= Op::kBitAnd;
  if (adds && a.most > kMost / 2 - b.most / 2) op = Op::kGe;
  steps.push_back({op, 0});
  const std::int64_t most = op == Op::kMul                      ? a.most * b.most
                            : op == Op::kMod                    ? b.most
                            : op == Op::kDiv                    ? a.most + 1
                            : op < Op::kEq || op >= Op::kBitAnd ? a.most + b.most
                                                                : 1;
  return {meaning(op, a.value, b.value), most};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const Bytes structure = input.bytes(input.below(12));
  std::vector<ExprStep> steps;
  const Meaning wanted = tree(input, structure, kDepthMax, steps);
  const reflect::Expr expr{steps.data(), static_cast<std::uint8_t>(steps.size())};
  fuzz::require(steps.size() <= UINT8_MAX, "a table holds the expression");
  fuzz::require(reflect::evaluate(expr, structure) == wanted.value,
                "steps come to what the tree means");
  return 0;
}
