#include "tools/commands/explain/type_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/fault_text.h"
#include "codec/reflect/text_field.h"
#include "tools/commands/explain/table.h"

namespace rubric::explain {

using reflect::EnumTable;
using reflect::Field;
using reflect::Kind;
using reflect::MaskTable;
using reflect::Protocol;
using reflect::Repeat;
using reflect::Type;

namespace {

/// Returns whether the expression is the number of a field alone.
bool is_number(const reflect::Expr& expr) { return expr.count == 1 && is_load(expr.steps[0].op); }

template <class T>
void add_once(std::vector<const T*>& list, const T* item) {
  if (item && std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

/// A message's fields, structures of one kind unfolded.
class Layout {
 public:
  void add(const Type& type, const std::string& prefix, std::int32_t base) {
    for (int i = 0; i < type.field_count; ++i) add_field(type, type.fields[i], prefix, base, "");
    for (int i = 0; i < type.interpretation_count; ++i) {
      const reflect::Interpretation& interpretation = type.interpretations[i];
      add_field(type, interpretation.field, prefix, base,
                type.fields[interpretation.overlays].name);
    }
  }

  std::string text() const {
    return "\n" + table_.text_within(kColumns, 2) + choices_ + enums_text() + masks_text();
  }

 private:
  void add_field(const Type& owner, const Field& f, const std::string& prefix, std::int32_t base,
                 const std::string& in_place_of) {
    const bool placed = f.fixed_offset >= 0 && base >= 0;
    const std::int32_t offset = placed ? base + f.fixed_offset : -1;
    const std::string path = prefix + f.name;
    std::string doc = first_sentence(f.doc);
    if (!in_place_of.empty()) doc = fmt::format("In place of {}", in_place_of);
    if (f.condition.count) {
      doc += fmt::format("{} {}", in_place_of.empty() ? " Only if" : " if",
                         expr_text(f.condition, owner));
    }
    const reflect::Requirement& rule = reflect::requirement(f.requirement);
    table_.add({placed ? std::to_string(offset) : "..", size_text(f, owner), path,
                type_text(f, owner), valid_text(f), unit_text(f), names_of(f), rule.id, doc});
    if (f.choice) add_choice(owner, f, path);
    add_once(enums_, f.enumeration);
    add_once(masks_, f.mask);
    if (f.kind != Kind::kStruct || !f.type || !in_place_of.empty()) return;
    add(*f.type, path + (f.repeat == Repeat::kOnce ? "." : "[]."),
        f.repeat == Repeat::kOnce ? offset : -1);
  }

  static std::string names_of(const Field& f) {
    if (f.enumeration) return f.enumeration->name;
    return f.mask ? f.mask->name : "";
  }

  void add_choice(const Type& owner, const Field& f, const std::string& path) {
    const Field* key_field = nullptr;
    if (is_number(f.choice->key)) path_of(f.choice->key.steps[0], owner, &key_field);
    const EnumTable* names = key_field ? key_field->enumeration : nullptr;
    choices_ += fmt::format("\n  {} by {}", path, expr_text(f.choice->key, owner));
    if (f.condition.count) choices_ += fmt::format(", if {}", expr_text(f.condition, owner));
    choices_ += ":\n";
    for (int i = 0; i < f.choice->count; ++i) {
      const reflect::SwitchCase& c = f.choice->cases[i];
      choices_ += fmt::format("    {}: {}\n", key_text(c.key, names), c.type->id);
    }
    choices_ += fmt::format("    any other: {}\n",
                            f.choice->otherwise ? f.choice->otherwise->id : "opaque bytes");
  }

  std::string enums_text() const {
    std::string out;
    for (const EnumTable* table : enums_) {
      std::vector<std::string> values;
      for (int i = 0; i < table->count; ++i) {
        const reflect::EnumEntry& entry = table->entries[i];
        values.push_back(fmt::format("{}{}{}", entry.value, kFirmBlank, entry.name));
      }
      out += fmt::format("\n  {}:\n{}", table->name,
                         wrapped(fmt::format("{}", fmt::join(values, ", ")), 4));
    }
    return out;
  }

  std::string masks_text() const {
    std::string out;
    for (const MaskTable* table : masks_) {
      std::vector<std::string> bits;
      for (int i = 0; i < table->width_bits; ++i) {
        const char* name = table->bit_names[i];
        if (name) bits.push_back(fmt::format("{:#x}{}{}", 1u << i, kFirmBlank, name));
      }
      out += fmt::format("\n  {}:\n{}", table->name,
                         wrapped(fmt::format("{}", fmt::join(bits, ", ")), 4));
    }
    return out;
  }

  Table table_{{"offset", "size", "field", "type", "valid", "unit", "names", "rule", "doc"}};
  std::string choices_;
  std::vector<const EnumTable*> enums_;
  std::vector<const MaskTable*> masks_;
};

std::string rule_text(ReqId id, std::size_t indent) {
  const reflect::Requirement& rule = reflect::requirement(id);
  return wrapped(fmt::format("{} ({}): {}", rule.id, rule.level, rule.sentence), indent);
}

// Visits every field of a protocol with the name that leads to it.
template <class Visit>
void each_field(const Protocol& protocol, Visit visit) {
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& type = *protocol.types[i];
    for (int k = 0; k < type.field_count; ++k) visit(type, type.fields[k]);
    for (int k = 0; k < type.interpretation_count; ++k) visit(type, type.interpretations[k].field);
  }
}

}  // namespace

using reflect::Expr;
using reflect::ExprStep;
using reflect::Extent;
using reflect::Field;
using reflect::Kind;
using reflect::Op;
using reflect::Repeat;
using reflect::Type;
using reflect::ValidKind;

namespace {

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

/// Returns how many of the steps from `at` on read the bits of `f`: its bytes joined, without the
/// bits above and below; 0 if they read something else.
int steps_of_bits(const Field& f, const Type& type, const Expr& expr, int at) {
  const auto index = static_cast<std::uint16_t>(&f - type.fields + 1);
  const auto is = [&](Op op, std::int64_t value, std::uint16_t from) {
    const ExprStep& step = expr.steps[at];
    return at++ < expr.count && step.op == op && step.value == value && step.from == from;
  };
  const auto is_by = [&](std::int64_t value, Op op) {
    return is(Op::kConst, value, 0) && is(op, 0, 0);
  };
  const int begin = at;
  const std::uint16_t from = expr.steps[at].from == 0 ? 0 : index;
  const int top = f.bit_width + f.bit_shift - 8 * (f.width_bytes - 1);
  for (int i = 0; i < f.width_bytes; ++i) {
    const int byte = f.little_endian ? f.width_bytes - 1 - i : i;
    if (i > 0 && !is_by(256, Op::kMul)) return 0;
    if (!is(Op::kLoadU8, std::max(f.fixed_offset, 0) + byte, from)) return 0;
    if (i == 0 && top < 8 && !is_by(std::int64_t{1} << top, Op::kMod)) return 0;
    if (i > 0 && !is(Op::kAdd, 0, 0)) return 0;
  }
  return is_by(std::int64_t{1} << f.bit_shift, Op::kDiv) ? at - begin : 0;
}

}  // namespace

std::string path_of(const ExprStep& load, const Type& type, const Field** field) {
  if (load.from == 0) return path_at(type, load.value, field);
  *field = &type.fields[load.from - 1];
  return (*field)->name;
}

namespace {

struct Operator {
  Op op;
  const char* text;
  int precedence;
};
constexpr Operator kOperators[] = {
    {Op::kMul, "*", 10},   {Op::kDiv, "/", 10},        {Op::kMod, "%", 10},
    {Op::kAdd, "+", 9},    {Op::kSub, "-", 9},         {Op::kShiftLeft, "<<", 8},
    {Op::kBitAnd, "&", 7}, {Op::kShiftRight, ">>", 8}, {Op::kBitXor, "^", 6},
    {Op::kBitOr, "|", 5},  {Op::kLt, "<", 4},          {Op::kLe, "<=", 4},
    {Op::kGt, ">", 4},     {Op::kGe, ">=", 4},         {Op::kEq, "==", 3},
    {Op::kNe, "!=", 3},    {Op::kAnd, "and", 2},       {Op::kOr, "or", 1},
};
constexpr int kAtom = 11;

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
  return {.text = fmt::format("{} {} {}", a.text, with.text, b.text),
          .precedence = with.precedence};
}

Operand operand(const ExprStep& step, const Type& type) {
  Operand result;
  if (step.op == Op::kConst) {
    result.text = std::to_string(step.value);
    result.is_const = true;
    result.value = step.value;
  } else {
    result.text = path_of(step, type, &result.field);
  }
  return result;
}

}  // namespace

std::string expr_text(const Expr& expr, const Type& type) {
  std::vector<Operand> stack;
  for (int i = 0; i < expr.count; ++i) {
    const ExprStep& step = expr.steps[i];
    int taken = 0;
    for (int k = 0; k < type.field_count && taken == 0; ++k) {
      const Field& f = type.fields[k];
      if (f.kind == Kind::kBits) taken = steps_of_bits(f, type, expr, i);
      if (taken != 0) stack.push_back({.text = f.name, .field = &f});
    }
    if (taken != 0) {
      i += taken - 1;
    } else if (step.op <= Op::kLoadLe32) {
      stack.push_back(operand(step, type));
    } else if (step.op == Op::kParam) {
      stack.push_back({type.params[step.value]});
    } else if (step.op == Op::kNot) {
      stack.back().text = "not (" + stack.back().text + ')';
    } else if (step.op == Op::kSelect) {
      const std::size_t at = stack.size() - 3;
      stack[at] = {.text = fmt::format("{} ? {} : {}", stack[at].text, stack[at + 1].text,
                                       stack[at + 2].text),
                   .precedence = 0};
      stack.resize(at + 1);
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
  return reflect::encoding_name(*f.text);
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
  if (f.repeat == Repeat::kUntil) return text + "[until]";
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
  if (f.repeat == Repeat::kUntil) return fmt::format("{}..", each);
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

std::string explain_type(const Protocol& protocol, const Type& type) {
  std::string out = fmt::format("{}: {} bytes", type.id, size_text(type));
  if (std::string_view(type.name) != type.id) out += fmt::format(", shown as {}", type.name);
  out += '\n' + wrapped(type.doc ? type.doc : "", 2);
  if (type.doc_ref && *type.doc_ref) out += fmt::format("  Source: {}\n", type.doc_ref);
  Layout layout;
  layout.add(type, "", 0);
  out += layout.text();
  const std::vector<Reach> found = reaches(protocol, type);
  if (!found.empty()) out += "\n  Reached as\n";
  for (const std::string& text : reach_texts(found)) out += wrapped(text, 4);
  if (type.requirement != ReqId::kNone) out += "\n" + rule_text(type.requirement, 2);
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& other = *protocol.types[i];
    if (&other == &type || std::string_view(other.name) != type.name) continue;
    out += fmt::format("\n  See also {}: {}\n", other.id, first_sentence(other.doc));
  }
  return out;
}

std::string used_by(const std::vector<const Protocol*>& protocols,
                    const std::function<bool(const Field&)>& has) {
  std::string out;
  for (const Protocol* protocol : protocols) {
    std::vector<std::string> names;
    each_field(*protocol, [&](const Type& type, const Field& f) {
      std::string name = fmt::format("{}.{}", type.id, f.name);
      if (has(f) && std::find(names.begin(), names.end(), name) == names.end()) {
        names.push_back(std::move(name));
      }
    });
    if (names.empty()) continue;
    out += wrapped(fmt::format("Used by {}: {}", protocol->id, fmt::join(names, ", ")), 2);
  }
  return out;
}

std::string explain_enum(const Protocol& protocol, const EnumTable& table) {
  std::string out = fmt::format("{}: enum, {} values\n", table.name, table.count);
  Table rows({"value", "hex", "name"});
  rows.align_right(0);
  rows.align_right(1);
  for (int i = 0; i < table.count; ++i) {
    const reflect::EnumEntry& entry = table.entries[i];
    rows.add({std::to_string(entry.value), fmt::format("{:#x}", entry.value), entry.name});
  }
  return out + rows.text(2) +
         used_by({&protocol}, [&](const Field& f) { return f.enumeration == &table; });
}

std::string explain_mask(const Protocol& protocol, const MaskTable& table) {
  std::string out = fmt::format("{}: mask of {} bits\n", table.name, table.width_bits);
  Table rows({"bit", "value", "name"});
  rows.align_right(0);
  rows.align_right(1);
  for (int i = 0; i < table.width_bits; ++i) {
    const char* name = table.bit_names[i];
    rows.add({std::to_string(i), fmt::format("{:#06x}", 1u << i), name ? name : "(unnamed)"});
  }
  return out + rows.text(2) +
         used_by({&protocol}, [&](const Field& f) { return f.mask == &table; });
}

using reflect::Field;
using reflect::Protocol;
using reflect::Type;

namespace {

// Both radio framings lead to the same messages.
std::string carrier_of(const Protocol& protocol, const Type& type) {
  for (int i = 0; i < protocol.carrier_count; ++i) {
    if (protocol.carriers[i].type != &type) continue;
    const std::string_view name = protocol.carriers[i].name;
    return std::string(name.starts_with("radio") ? "radio" : name);
  }
  return {};
}

bool leads_to(const Field& f, const Type& message, Reach& reach) {
  if (f.kind != reflect::Kind::kStruct) return false;
  if (!f.choice) return f.type == &message;
  for (int i = 0; i < f.choice->count; ++i) {
    if (f.choice->cases[i].type == &message) reach.values.push_back(f.choice->cases[i].key);
  }
  reach.otherwise = f.choice->otherwise == &message;
  if (reach.values.empty() && !reach.otherwise) return false;
  reach.key = expr_text(f.choice->key, *reach.parent);
  if (is_number(f.choice->key)) path_of(f.choice->key.steps[0], *reach.parent, &reach.key_field);
  return true;
}

bool same_carrier_way(const Reach& a, const Reach& b) {
  return !a.carrier.empty() && a.carrier == b.carrier && a.values == b.values;
}

void add(const Protocol& protocol, const Type& parent, const Field& f, const Type& message,
         std::vector<Reach>& found) {
  Reach reach{.parent = &parent, .field = &f};
  if (!leads_to(f, message, reach)) return;
  reach.condition = expr_text(f.condition, parent);
  if (!reach.key.empty()) reach.carrier = carrier_of(protocol, parent);
  for (const Reach& known : found) {
    if (same_carrier_way(known, reach)) return;
  }
  found.push_back(std::move(reach));
}

}  // namespace

std::vector<Reach> reaches(const Protocol& protocol, const Type& message) {
  std::vector<Reach> found;
  for (int i = 0; i < protocol.type_count; ++i) {
    const Type& parent = *protocol.types[i];
    for (int k = 0; k < parent.field_count; ++k) {
      add(protocol, parent, parent.fields[k], message, found);
    }
    for (int k = 0; k < parent.interpretation_count; ++k) {
      add(protocol, parent, parent.interpretations[k].field, message, found);
    }
  }
  std::stable_partition(found.begin(), found.end(),
                        [](const Reach& reach) { return !reach.carrier.empty(); });
  return found;
}

namespace {

std::string text_in(const Reach& reach, const char* parent) {
  std::string values;
  const reflect::EnumTable* names = reach.key_field ? reach.key_field->enumeration : nullptr;
  for (std::size_t i = 0; i < reach.values.size(); ++i) {
    values += (i ? ", " : "") + (reach.carrier.empty() ? key_text(reach.values[i], names)
                                                       : std::to_string(reach.values[i]));
  }
  if (!reach.carrier.empty()) return fmt::format("AM {} on {}", values, reach.carrier);
  std::string text = fmt::format("{} of {}", reach.field->name, parent);
  if (!reach.condition.empty()) text += " if " + reach.condition;
  if (reach.key.empty()) return text;
  if (reach.otherwise) values += values.empty() ? "any other" : " or any other";
  return text +
         fmt::format("{} {} is {}", reach.condition.empty() ? " if" : " and", reach.key, values);
}

}  // namespace

std::string reach_text(const Reach& reach) { return text_in(reach, reach.parent->id); }

std::vector<std::string> reach_texts(const std::vector<Reach>& reaches) {
  std::vector<std::string> texts;
  for (const Reach& reach : reaches) {
    const std::string shared = text_in(reach, reach.parent->name);
    const auto alike = std::count_if(reaches.begin(), reaches.end(), [&](const Reach& other) {
      return text_in(other, other.parent->name) == shared;
    });
    const std::string text = alike > 1 ? shared : reach_text(reach);
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  }
  return texts;
}

std::vector<std::int64_t> am_types(const std::vector<Reach>& reaches) {
  std::vector<std::int64_t> types;
  for (const Reach& reach : reaches) {
    if (!reach.carrier.empty()) types.insert(types.end(), reach.values.begin(), reach.values.end());
  }
  std::sort(types.begin(), types.end());
  types.erase(std::unique(types.begin(), types.end()), types.end());
  return types;
}

bool is_carrier(const Protocol& protocol, const Type& type) {
  return !carrier_of(protocol, type).empty();
}

}  // namespace rubric::explain
