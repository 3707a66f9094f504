#include <fmt/format.h>

#include <algorithm>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/lua_code.h"

namespace rubricc::lua {
namespace {

constexpr std::string_view kFile = R"(<<banner>>
-- A Wireshark dissector: `rubric install-wireshark` lays it into the folder of Lua plugins.

-- The wire spec as tables.
local enums, masks, types, rules = {}, {}, {}, {}

<<tables>>

local serial_frame = <<serial_frame>>
local protocols = {
<<protocols>>
}
local protocol_choices = {
<<choices>>
}
local usual_protocol = <<usual>>

<<decode>>

<<crc16>>

<<wireshark>>
)";

std::string quote(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n') {
      out += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

template <class Named>
std::string full_name(const Named& named) {
  return quote(named.spec->id + "." + named.id);
}

std::string load_text(const Expr& expr) {
  if (expr.param >= 0) return fmt::format("d.params[{}]", expr.param + 1);
  const Field& field = *expr.field;
  const std::string at = expr.from < 0 ? "d" : fmt::format("d:from({})", expr.from + 1);
  if (field.bit_width > 0) {
    const std::string bits =
        fmt::format("{}:bits({}, {}, {}, {}, {})", at, expr.offset_bytes, field.width_bytes,
                    field.little_endian, field.bit_shift, field.bit_width);
    const bool is_bool = field.bit_width == 1 && field.enumeration == nullptr && !expr.to_i;
    return is_bool ? "(" + bits + " == 1)" : bits;
  }
  const std::string order = field.width_bytes == 1 ? "u" : field.little_endian ? "le" : "be";
  return fmt::format("{}:{}{}({})", at, order, 8 * field.width_bytes, expr.offset_bytes);
}

std::string_view operator_text(ExprOp op) {
  switch (op) {
    case ExprOp::kNe: return "~=";
    case ExprOp::kAnd: return "and";
    case ExprOp::kOr: return "or";
    default: return infix(op);
  }
}

std::string expr_text(const Expr& expr) {
  if (expr.is_bool) return expr.value != 0 ? "true" : "false";
  if (expr.op == ExprOp::kInt || expr.op == ExprOp::kEnumValue) return std::to_string(expr.value);
  if (expr.op == ExprOp::kField) return load_text(expr);
  const std::string left = expr_text(*expr.operands[0]);
  if (expr.op == ExprOp::kNot) return "not (" + left + ")";
  const std::string right = expr_text(*expr.operands[1]);
  if (expr.op == ExprOp::kDiv) return fmt::format("d:quotient({}, {})", left, right);
  if (expr.op == ExprOp::kMod) return fmt::format("d:remainder({}, {})", left, right);
  if (expr.op == ExprOp::kSelect) {
    return fmt::format("d:select({}, {}, {})", left, right, expr_text(*expr.operands[2]));
  }
  if (expr.op >= ExprOp::kBitAnd) {
    constexpr std::string_view kNames[] = {"bit_and", "bit_or", "bit_xor", "left", "right"};
    const auto at = static_cast<std::size_t>(expr.op) - static_cast<std::size_t>(ExprOp::kBitAnd);
    return fmt::format("d:{}({}, {})", kNames[at], left, right);
  }
  const auto side = [](const Expr& operand, const std::string& text) {
    return operand.operands.empty() ? text : "(" + text + ")";
  };
  return fmt::format("{} {} {}", side(*expr.operands[0], left), operator_text(expr.op),
                     side(*expr.operands[1], right));
}

std::string function_text(const Expr& expr) {
  return "function(d) return " + expr_text(expr) + " end";
}

/// `key = value` pairs of a Lua table.
class Entry {
 public:
  void add(std::string_view key, std::string value) {
    pairs_.push_back(fmt::format("{} = {}", key, value));
  }
  void add_text(std::string_view key, std::string_view text) {
    if (!text.empty()) add(key, quote(text));
  }
  void add_function(std::string_view key, const ExprPtr& expr) {
    if (expr) add(key, function_text(*expr));
  }
  std::string text() const { return fmt::format("{{{}}}", fmt::join(pairs_, ", ")); }

 private:
  std::vector<std::string> pairs_;
};

/// By ValueKind.
constexpr const char* kKinds[] = {"uint", "sint", "float", "", "mask", "bytes", "struct"};

std::string number_list(const std::vector<std::int64_t>& values) {
  return fmt::format("{{{}}}", fmt::join(values, ", "));
}

/// Returns what the parameters of a type are for one use of it; conditions have no range.
std::string argument_list(const Type& type, const std::vector<ExprPtr>& given) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < given.size(); ++i) {
    Entry one;
    one.add_function("value", given[i]);
    if (!type.params[i].is_bool) {
      one.add("min", std::to_string(type.params[i].range.min));
      one.add("max", std::to_string(type.params[i].range.max));
    }
    out.push_back(one.text());
  }
  return fmt::format("{{{}}}", fmt::join(out, ", "));
}

void add_choice(const Switch& choice, Entry& entry) {
  entry.add_function("key", choice.key);
  std::vector<std::string> cases, arguments;
  const auto add_arguments = [&](const std::string& key, const SwitchCase& one) {
    if (one.arguments.empty()) return;
    arguments.push_back(fmt::format("{} = {}", key, argument_list(*one.type, one.arguments)));
  };
  for (const SwitchCase& one : choice.cases) {
    if (one.type == nullptr) continue;
    const std::string key = fmt::format("[{}]", one.key);
    cases.push_back(fmt::format("{} = {}", key, full_name(*one.type)));
    add_arguments(key, one);
  }
  entry.add("cases", fmt::format("{{{}}}", fmt::join(cases, ", ")));
  if (choice.otherwise) {
    entry.add("otherwise", full_name(*choice.otherwise->type));
    add_arguments("otherwise", *choice.otherwise);
  }
  if (!arguments.empty()) {
    entry.add("case_arguments", fmt::format("{{{}}}", fmt::join(arguments, ", ")));
  }
}

void add_range(const Field& field, Entry& entry) {
  const std::string min = std::to_string(*field.valid->min);
  std::string max = std::to_string(*field.valid->max);
  if (field.width_bytes != 8) {
    entry.add("min", min);
    entry.add("max", max);
    return;
  }
  if (field.kind == ValueKind::kUint) {
    max = std::to_string(static_cast<std::uint64_t>(*field.valid->max));
  }
  entry.add("min", min + ".0");  // Doubles, as the values are, which shows them rounded.
  entry.add("max", max + ".0");
  entry.add_text("allowed", min + " to " + max);
}

std::string field_text(const Field& field) {
  Entry entry;
  entry.add_text("name", field.name);
  entry.add_text("kind", kKinds[static_cast<std::size_t>(field.kind)]);
  if (field.bit_width != 0) {
    entry.add("bits", std::to_string(field.bit_width));
    entry.add("shift", std::to_string(field.bit_shift));
    if (field.shared_bytes() != 0) entry.add("shares", "true");
  }
  if (field.width_bytes != 0) entry.add("width", std::to_string(field.width_bytes));
  if (field.little_endian && field.width_bytes > 1) entry.add("little", "true");
  if (field.valid && field.valid->one_of.empty()) {
    add_range(field, entry);
  } else if (field.valid) {
    entry.add("one_of", number_list(field.valid->one_of));
  }
  if (field.expect) entry.add("expect", std::to_string(*field.expect));
  if (field.enumeration != nullptr) entry.add("enum", full_name(*field.enumeration));
  if (field.kind == ValueKind::kMask) entry.add("mask", full_name(*field.type));
  if (field.kind == ValueKind::kStruct && field.type != nullptr) {
    entry.add("type", full_name(*field.type));
    if (!field.arguments.empty()) {
      entry.add("arguments", argument_list(*field.type, field.arguments));
    }
  }
  if (field.choice) add_choice(*field.choice, entry);
  if (field.repeat != RepeatKind::kOnce) entry.add("repeated", "true");
  if (field.extent == ExtentKind::kToEnd) entry.add("to_end", "true");
  entry.add_function("size", field.size);
  entry.add_function("count", field.count);
  entry.add_function("condition", field.condition);
  entry.add_function("ends", field.until);
  if (field.extent == ExtentKind::kTerminated) {
    entry.add("ends_with",
              fmt::format("string.char({}):rep({})", field.text->terminator, field.text->unit));
    if (field.text->may_lack_its_end) entry.add("may_lack_its_end", "true");
  }
  // Text in another encoding is shown as bytes.
  if (field.text && field.text->encoding != Encoding::kNone &&
      field.text->encoding != Encoding::kOther) {
    entry.add_text("text", field.text->encoding == Encoding::kAscii ? "ASCII" : "UTF-8");
    if (field.text->terminator >= 0) {
      entry.add("terminator", std::to_string(field.text->terminator));
    }
    if (field.text->padding >= 0) entry.add("padding", std::to_string(field.text->padding));
  }
  if (field.unit) {
    entry.add_text("unit", field.unit->symbol);
    entry.add("scale", fmt::format("{}", field.unit->scale));
    entry.add("zero", fmt::format("{}", field.unit->offset));
  }
  if (field.is_instance) {
    entry.add("message", "true");
    entry.add("overlays", std::to_string(field.overlays + 1));
  }
  entry.add_text("rule", field.requirement);
  entry.add_text("doc", field.doc);
  return entry.text();
}

std::string type_table(const Type& type) {
  std::string out = fmt::format("types[{}] = {{\n  name = {},", full_name(type), quote(type.name));
  if (type.max_size != UINT32_MAX) out += fmt::format(" max = {},", type.max_size);
  if (!type.constant_size() || type.max_size == 0) {  // As elements such are read one by one.
    out += fmt::format(" min = {},", type.min_size);
  }
  if (!type.requirement.empty()) out += fmt::format(" rule = {},", quote(type.requirement));
  if (!type.doc.empty()) out += "\n  doc = " + quote(type.doc) + ",";
  for (const auto& field : type.fields) out += "\n  " + field_text(*field) + ",";
  std::string interpretations;
  for (const auto& instance : type.instances) {
    if (instance->overlays >= 0) interpretations += "\n    " + field_text(*instance) + ",";
  }
  if (!interpretations.empty()) out += "\n  interpretations = {" + interpretations + "\n  },";
  return out + "\n}\n";
}

std::string enum_table(const Enum& one) {
  std::vector<std::string> entries;
  for (const EnumEntry& entry : one.entries) {
    entries.push_back(fmt::format("[{}] = {}", entry.value, quote(entry.name)));
  }
  return fmt::format("enums[{}] = {{{}}}\n", full_name(one), fmt::join(entries, ", "));
}

/// Returns bits from the least significant, in a list that begins at 1.
std::string mask_table(const Type& type) {
  std::vector<std::string> bits;
  for (auto bit = type.bits.rbegin(); bit != type.bits.rend(); ++bit) {
    bits.push_back(bit->unnamed ? "false" : quote(bit->name));
  }
  return fmt::format("masks[{}] = {{count = {}, {}}}\n", full_name(type), bits.size(),
                     fmt::join(bits, ", "));
}

std::string spec_tables(const Spec& spec) {
  std::string out;
  for (const auto& one : spec.enums) out += enum_table(*one);
  for (const auto& type : spec.types) out += type->is_mask ? mask_table(*type) : type_table(*type);
  return out;
}

/// Returns the rules that a fault can name.
std::string rule_tables(const Model& model) {
  std::string out;
  for (const Requirement& rule : model.requirements) {
    if (!rule.id.starts_with("WIRE-")) continue;
    out += fmt::format("rules[{}] = {{level = {}, text = {}}}\n", quote(rule.id), quote(rule.level),
                       quote(rule.sentence));
  }
  return out;
}

/// Returns the richest protocol first: it is the one that a reader most likely has.
std::vector<const Spec*> protocols_of(const Model& model) {
  std::vector<const Spec*> out;
  for (const auto& spec : model.specs) {
    const bool leads = std::any_of(spec->types.begin(), spec->types.end(),
                                   [](const auto& type) { return leads_to_messages(*type); });
    if (spec->named && leads) out.push_back(spec.get());
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Spec* a, const Spec* b) { return a->types.size() > b->types.size(); });
  return out;
}

std::string protocol_text(const Spec& spec) {
  Entry carriers;
  for (const auto& type : spec.types) {
    if (!type->carrier.empty()) carriers.add(type->carrier, full_name(*type));
  }
  return fmt::format("  {{name = {}, carriers = {}}},", quote(spec.id), carriers.text());
}

std::string serial_frame_of(const Model& model) {
  for (const auto& spec : model.specs) {
    for (const auto& type : spec->types) {
      if (type->framing == "hdlc") return full_name(*type);
    }
  }
  return "nil";
}

}  // namespace
}  // namespace rubricc::lua

namespace rubricc {

bool leads_to_messages(const Type& type) {
  return type.carrier == "serial" || type.carrier == "radio_i" || type.carrier == "radio_t";
}

GeneratedFiles emit_lua(const Model& model, std::string_view usual) {
  using namespace lua;
  const std::vector<const Spec*> protocols = protocols_of(model);
  if (protocols.empty()) return {};
  std::string tables, carriers, choices, files;
  std::size_t usual_at = 1;
  for (const auto& spec : model.specs) tables += spec_tables(*spec);
  for (std::size_t i = 0; i < protocols.size(); ++i) {
    const Spec& spec = *protocols[i];
    carriers += protocol_text(spec) + "\n";
    choices += fmt::format("  {{{}, {}, {}}},\n", i + 1, lua::quote(spec.title), i + 1);
    if (spec.id == usual) usual_at = i + 1;
    files += (i == 0 ? "" : " ") + spec.file;
  }
  const auto lines = [](std::string text) {
    while (text.ends_with('\n')) text.pop_back();
    return text;
  };
  const std::string text =
      fill(kFile, {{"banner", banner("-- ", files)},
                   {"tables", lines(tables + rule_tables(model))},
                   {"serial_frame", serial_frame_of(model)},
                   {"protocols", lines(carriers)},
                   {"choices", lines(choices)},
                   {"usual", std::to_string(usual_at)},
                   {"decode", lines(std::string(lua_code().at("decode")))},
                   {"crc16", lines(std::string(lua_code().at("crc16")))},
                   {"wireshark", lines(std::string(lua_code().at("wireshark")))}});
  return {{"tools/wireshark/generated/rubric.lua", text}};
}

}  // namespace rubricc
