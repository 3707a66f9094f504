// Emits dictionaries for libFuzzer: constants and borders of ranges as bytes.
#include <fmt/format.h>

#include <set>

#include "spec/compiler/check/intervals.h"
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"

namespace rubricc {
namespace {

/// Words in the order of the spec; the same bytes come once, under their first name.
class Dictionary {
 public:
  void add(const std::string& name, const std::string& bytes) {
    if (!seen_.insert(bytes).second) return;
    if (!comment_.empty()) text_ += "\n# " + comment_ + "\n";
    comment_.clear();
    std::string text;
    for (const char c : bytes) text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    text_ += fmt::format("{}=\"{}\"\n", name, text);
  }

  void number(const std::string& name, std::int64_t value, int width, bool little_endian) {
    std::string bytes;
    for (int i = 0; i < width; ++i) {
      const int shift = 8 * (little_endian ? i : width - 1 - i);
      bytes += static_cast<char>(value >> shift & 0xFF);
    }
    add(name, bytes);
  }

  /// Written before the next word that is new.
  void comment(const std::string& text) { comment_ = text; }
  const std::string& text() const { return text_; }

 private:
  std::set<std::string> seen_;
  std::string text_;
  std::string comment_;
};

void add_field(Dictionary& out, const Type& type, const Field& field) {
  const std::string name = fmt::format("{}_{}", type.id, field.id);
  const auto add = [&](const std::string& suffix, std::int64_t value) {
    const Interval width = width_range(field.width_bytes, field.kind == ValueKind::kSint);
    if (value < width.min || value > width.max) return;
    out.number(name + suffix, value, field.width_bytes, field.little_endian);
  };
  if (field.enumeration != nullptr) {
    for (const EnumEntry& entry : field.enumeration->entries) add("_" + entry.name, entry.value);
  }
  if (field.expect) add("_expected", *field.expect);
  if (!field.valid) return;
  for (const std::int64_t value : field.valid->one_of) add("_valid", value);
  if (!field.valid->min) return;
  add("_min", *field.valid->min);
  add("_max", *field.valid->max);
  add("_below_min", *field.valid->min - 1);
  add("_above_max", *field.valid->max + 1);
}

void add_cases(Dictionary& out, const Type& type, const Field& field) {
  if (!field.choice || field.choice->key->op != ExprOp::kField) return;
  const Field& key = *field.choice->key->field;
  for (const SwitchCase& one : field.choice->cases) {
    out.number(fmt::format("{}_{}_is_{}", type.id, field.id, one.type->id), one.key,
               key.width_bytes, key.little_endian);
  }
}

}  // namespace

GeneratedFiles emit_dictionary(const Spec& spec) {
  Dictionary out;
  out.comment("AM types");
  for (const auto& type : spec.types) {
    for (const std::int64_t value : type->am_types) out.number("am_" + type->id, value, 1, false);
  }
  for (const auto& type : spec.types) {
    if (type->is_mask) continue;
    out.comment(type->id);
    if (type->framing == "hdlc") {
      out.add("flag", "\x7e");
      out.add("escaped_flag", "\x7d\x5e");
      out.add("escaped_escape", "\x7d\x5d");
      out.add("abort", "\x7d\x7e");
    }
    for (const auto& field : type->fields) {
      add_field(out, *type, *field);
      add_cases(out, *type, *field);
    }
    for (const auto& field : type->instances) add_cases(out, *type, *field);
  }
  out.comment("floats");
  for (const bool little : {false, true}) {
    const std::string order = little ? "_le" : "_be";
    out.number("nan" + order, 0x7FC00000, 4, little);
    out.number("infinity" + order, 0x7F800000, 4, little);
    out.number("minus_infinity" + order, 0xFF800000, 4, little);
    out.number("denormal" + order, 1, 4, little);
  }
  return {
      {fmt::format("fuzz/dictionaries/{}.dict", spec.id), banner("# ", spec.file) + out.text()}};
}

}  // namespace rubricc
