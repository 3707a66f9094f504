#include "tools/explain/explain_type.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "codec/reflect/fault_text.h"
#include "tools/explain/reach.h"
#include "tools/explain/table.h"
#include "tools/explain/type_text.h"

namespace rubric::explain {

using reflect::EnumTable;
using reflect::Field;
using reflect::Kind;
using reflect::MaskTable;
using reflect::Protocol;
using reflect::Repeat;
using reflect::Type;

namespace {

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
    if (f.choice->key.count == 1) path_at(owner, f.choice->key.steps[0].value, &key_field);
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
    for (int k = 0; k < type.interpretation_count; ++k) {
      visit(type, type.interpretations[k].field);
    }
  }
}

}  // namespace

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

}  // namespace rubric::explain
