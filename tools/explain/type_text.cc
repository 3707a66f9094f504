#include "tools/explain/type_text.h"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "codec/reflect/decode.h"

namespace rubric::explain {

using reflect::Expr;
using reflect::ExprStep;
using reflect::Extent;
using reflect::Field;
using reflect::Kind;
using reflect::Op;
using reflect::Repeat;
using reflect::Type;
using reflect::ValidKind;

std::string path_at(const Type& type, std::int32_t offset, const Field** field) {
  *field = nullptr;
  for (int i = 0; i < type.field_count; ++i) {
    const Field& f = type.fields[i];
    if (f.fixed_offset < 0 || f.fixed_offset > offset || f.repeat != Repeat::kOnce) continue;
    if (f.fixed_offset == offset && f.kind <= Kind::kMask && f.kind != Kind::kBits) {
      *field = &f;
      return f.name;
    }
    if (f.kind == Kind::kStruct && f.type && f.type->max_size != UINT32_MAX &&
        offset < f.fixed_offset + static_cast<std::int32_t>(f.type->max_size)) {
      return std::string(f.name) + '.' + path_at(*f.type, offset - f.fixed_offset, field);
    }
  }
  return fmt::format("byte {}", offset);
}

namespace {

struct Operator {
  Op op;
  const char* text;
  int precedence;
};
constexpr Operator kOperators[] = {
    {Op::kMul, "*", 6}, {Op::kDiv, "/", 6}, {Op::kMod, "%", 6}, {Op::kAdd, "+", 5},
    {Op::kSub, "-", 5}, {Op::kLt, "<", 4},  {Op::kLe, "<=", 4}, {Op::kGt, ">", 4},
    {Op::kGe, ">=", 4}, {Op::kEq, "==", 3}, {Op::kNe, "!=", 3}, {Op::kAnd, "and", 2},
    {Op::kOr, "or", 1},
};
constexpr int kAtom = 9;

struct Operand {
  std::string text;
  int precedence = kAtom;
  const Field* field = nullptr;  // For a load.
  bool is_const = false;
  std::int64_t value = 0;
};

// Shows a number that is compared with an enum as the enumerator.
void name_constant(Operand& constant, const Operand& other) {
  if (!constant.is_const || !other.field || !other.field->enumeration) return;
  const char* name = reflect::enum_name(*other.field->enumeration, constant.value);
  if (name) constant.text = name;
}

Operand combined(Operand a, Operand b, const Operator& with) {
  if (with.op >= Op::kEq && with.op <= Op::kGe) {
    name_constant(a, b);
    name_constant(b, a);
  }
  if (a.precedence < with.precedence) a.text = '(' + a.text + ')';
  if (b.precedence <= with.precedence && b.precedence != kAtom) b.text = '(' + b.text + ')';
  Operand result;
  result.text = fmt::format("{} {} {}", a.text, with.text, b.text);
  result.precedence = with.precedence;
  return result;
}

Operand operand(const ExprStep& step, const Type& type) {
  Operand result;
  if (step.op == Op::kConst) {
    result.text = std::to_string(step.value);
    result.is_const = true;
    result.value = step.value;
  } else {
    result.text = path_at(type, step.value, &result.field);
  }
  return result;
}

}  // namespace

std::string expr_text(const Expr& expr, const Type& type) {
  std::vector<Operand> stack;
  for (int i = 0; i < expr.count; ++i) {
    const ExprStep& step = expr.steps[i];
    if (step.op <= Op::kLoadLe32) {
      stack.push_back(operand(step, type));
    } else if (step.op == Op::kNot) {
      stack.back().text = "not (" + stack.back().text + ')';
    } else {
      const Operand b = std::move(stack.back());
      stack.pop_back();
      for (const Operator& with : kOperators) {
        if (with.op == step.op) stack.back() = combined(std::move(stack.back()), b, with);
      }
    }
  }
  return stack.empty() ? std::string{} : stack.back().text;
}

namespace {

std::string bytes_name(const Field& f) {
  if (!f.text || f.text->encoding == reflect::Encoding::kNone) return "bytes";
  return f.text->encoding == reflect::Encoding::kAscii ? "ASCII" : "UTF-8";
}

}  // namespace

std::string type_text(const Field& f, const Type& owner) {
  std::string text;
  const char* order = f.width_bytes > 1 && f.little_endian ? "le" : "";
  switch (f.kind) {
    case Kind::kUint: text = fmt::format("u{}{}", 8 * f.width_bytes, order); break;
    case Kind::kSint: text = fmt::format("s{}{}", 8 * f.width_bytes, order); break;
    case Kind::kFloat: text = fmt::format("f{}{}", 8 * f.width_bytes, order); break;
    case Kind::kBits: return fmt::format("b{}{}", f.bit_width, f.little_endian ? "le" : "");
    case Kind::kMask: text = fmt::format("mask{}{}", 8 * f.width_bytes, order); break;
    case Kind::kBytes: text = bytes_name(f); break;
    case Kind::kStruct: text = f.type ? f.type->id : "by " + expr_text(f.choice->key, owner); break;
  }
  if (f.repeat == Repeat::kCount) return fmt::format("{}[{}]", text, expr_text(f.count, owner));
  if (f.repeat == Repeat::kToEnd) return text + "[...]";
  return text;
}

std::string size_text(const Field& f, const Type& owner) {
  if (f.extent == Extent::kSize) return expr_text(f.size, owner);
  if (f.extent == Extent::kTerminated) return fmt::format("to {:#04x}", f.text->terminator);
  if (f.extent == Extent::kToEnd || f.repeat == Repeat::kToEnd) return "rest";
  std::uint32_t each = f.width_bytes;
  if (f.kind == Kind::kStruct && f.type) {
    if (f.type->min_size != f.type->max_size) return size_text(*f.type);
    each = f.type->max_size;
  }
  if (f.repeat == Repeat::kOnce) return std::to_string(each);
  if (f.count.count == 1 && f.count.steps[0].op == Op::kConst) {
    return std::to_string(each * static_cast<std::uint32_t>(f.count.steps[0].value));
  }
  const std::string count = expr_text(f.count, owner);
  return each == 1 ? count : fmt::format("{} * {}", each, count);
}

std::string size_text(const Type& type) {
  if (type.max_size == UINT32_MAX) return fmt::format("from {}", type.min_size);
  if (type.min_size == type.max_size) return std::to_string(type.min_size);
  return fmt::format("{} to {}", type.min_size, type.max_size);
}

std::string valid_text(const Field& f) {
  std::string text;
  if (f.valid.kind == ValidKind::kRange) {
    text = f.valid.min == f.valid.max ? fmt::format("= {}", f.valid.min)
                                      : fmt::format("{} to {}", f.valid.min, f.valid.max);
  } else if (f.valid.kind == ValidKind::kOneOf) {
    for (int i = 0; i < f.valid.one_of_count; ++i) {
      text += (i ? " or " : "= ") + key_text(f.valid.one_of[i], f.enumeration);
    }
  }
  if (f.expect >= 0) {
    if (!text.empty()) text += ", ";
    text += "expected " + key_text(f.expect, f.enumeration);
  }
  return text;
}

std::string unit_text(const Field& f) {
  if (!f.unit) return {};
  if (f.unit->scale == 1 && f.unit->offset == 0) return f.unit->symbol;
  std::string text = fmt::format("{} = raw", f.unit->symbol);
  if (f.unit->scale != 1) text += fmt::format(" * {}", f.unit->scale);
  if (f.unit->offset < 0) text += fmt::format(" - {}", -f.unit->offset);
  if (f.unit->offset > 0) text += fmt::format(" + {}", f.unit->offset);
  return text;
}

std::string key_text(std::int64_t key, const reflect::EnumTable* enumeration) {
  const char* name = enumeration ? reflect::enum_name(*enumeration, key) : nullptr;
  return name ? fmt::format("{} ({})", key, name) : std::to_string(key);
}

std::string bits_text(const reflect::MaskTable& mask, std::int64_t value) {
  std::string text;
  for (int bit = 0; bit < mask.width_bits; ++bit) {
    if (!(value >> bit & 1)) continue;
    const char* name = mask.bit_names[bit];
    text += (text.empty() ? "" : ", ") + (name ? std::string(name) : fmt::format("bit{}", bit));
  }
  return text.empty() ? "none" : text;
}

std::string first_sentence(const char* doc) {
  const std::string_view text = doc ? doc : "";
  std::size_t end = text.find(". ");
  end = end == std::string_view::npos ? text.size() : end + 1;
  std::string sentence(text.substr(0, end));
  for (char& c : sentence) {
    if (c == '\n') c = ' ';
  }
  return sentence;
}

}  // namespace rubric::explain
