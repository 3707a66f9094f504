// The page about the wire: one type, with its fields and interpretations.
#include <fmt/format.h>

#include "spec/compiler/emit_doc.h"
#include "spec/compiler/expr_parser.h"
#include "spec/compiler/html.h"
#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::string_view kSection = R"(<section id="<<anchor>>">
<h3><<name>></h3>
<<doc?>>
<<facts>>
<<body>>
</section>
)";

std::string number_text(const Field& field) {
  const char* const sign = field.kind == ValueKind::kUint   ? "unsigned"
                           : field.kind == ValueKind::kSint ? "signed"
                                                            : "binary32";
  std::string out = sign;
  if (field.kind != ValueKind::kFloat) out += fmt::format(", {} bits", 8 * field.width_bytes);
  if (field.width_bytes > 1) out += field.little_endian ? ", little-endian" : ", big-endian";
  return out;
}

std::string choice_text(const Field& field) {
  std::string out = "by " + html_code(to_text(*field.choice->key)) + ": ";
  for (const SwitchCase& one : field.choice->cases) {
    out += html_escaped(to_text(*one.key_expr)) + " " + link_to(*one.type) + ", ";
  }
  out += field.choice->otherwise ? "else " + link_to(*field.choice->otherwise->type)
                                 : "else opaque bytes";
  return out;
}

std::string type_text(const Field& field) {
  std::string out;
  switch (field.kind) {
    case ValueKind::kBytes: out = "bytes"; break;
    case ValueKind::kMask: out = "mask " + link_to(*field.type); break;
    case ValueKind::kStruct: out = field.choice ? choice_text(field) : link_to(*field.type); break;
    default: out = number_text(field);
  }
  if (field.repeat == RepeatKind::kCount) out += " × " + html_code(to_text(*field.count));
  if (field.repeat == RepeatKind::kToEnd) out += ", repeated to the end";
  if (field.extent == ExtentKind::kSize) out += ", size " + html_code(to_text(*field.size));
  if (field.extent == ExtentKind::kToEnd) out += ", to the end";
  if (field.condition) out += ", only if " + html_code(to_text(*field.condition));
  return out;
}

std::string valid_text(const Field& field) {
  std::string out;
  if (field.valid && !field.valid->one_of.empty()) {
    for (const std::int64_t value : field.valid->one_of) {
      out += fmt::format("{}{}", out.empty() ? "" : ", ", value);
    }
  } else if (field.valid) {
    out = fmt::format("{} to {}", *field.valid->min, *field.valid->max);
  }
  if (field.expect) out += fmt::format("{}expected {}", out.empty() ? "" : "; ", *field.expect);
  return out;
}

std::string unit_text(const Field& field) {
  if (!field.unit) return {};
  const Unit& unit = *field.unit;
  if (unit.scale == 1 && unit.offset == 0) return html_escaped(unit.symbol);
  return html_escaped(fmt::format("{} × raw {} {} {}", unit.scale, unit.offset < 0 ? "-" : "+",
                                  unit.offset < 0 ? -unit.offset : unit.offset, unit.symbol));
}

HtmlTable fields_table(const Type& type) {
  HtmlTable table{"Fields of " + type.id,
                  {"field", "offset", "bytes", "type", "values", "valid", "unit", "rule",
                   "meaning"},
                  {}, {}};
  for (const auto& field : type.fields) {
    table.rows.push_back(
        {html_code(field->id),
         field->fixed_offset < 0 ? "varies" : std::to_string(field->fixed_offset),
         doc_range(field->min_size, field->max_size), type_text(*field),
         field->enumeration != nullptr ? link_to(*field->enumeration) : "", valid_text(*field),
         unit_text(*field), link_to_requirement(field->requirement), html_escaped(field->doc)});
  }
  return table;
}

std::string interpretations(const Type& type) {
  HtmlTable table{"Interpretations of " + type.id +
                      ": the first whose condition holds and whose type fits is shown",
                  {"instance", "overlays", "if", "type", "meaning"}, {}, {}};
  for (const auto& instance : type.instances) {
    if (instance->is_peek) continue;
    const auto overlaid = static_cast<std::size_t>(instance->overlays);
    const std::string condition = instance->condition ? to_text(*instance->condition) : "always";
    table.rows.push_back(
        {html_code(instance->id), html_code(type.fields[overlaid]->id), html_code(condition),
         instance->choice ? choice_text(*instance) : link_to(*instance->type),
         html_escaped(instance->doc)});
  }
  return table.rows.empty() ? "" : table.text();
}

HtmlTable bits_table(const Type& type) {
  HtmlTable table{"Bits of " + type.id, {"bit", "value", "name"}, {}, {}};
  for (std::size_t i = 0; i < type.bits.size(); ++i) {
    const std::size_t bit = type.bits.size() - 1 - i;
    const MaskBit& one = type.bits[i];
    table.rows.push_back({std::to_string(bit), fmt::format("0x{:04x}", 1U << bit),
                          one.unnamed ? "unnamed" : html_code(one.name)});
  }
  return table;
}

std::string facts(const Type& type) {
  std::string out = "<p class=\"facts\">" + doc_range(type.min_size, type.max_size) + " bytes";
  for (const std::int64_t value : type.am_types) {
    out += fmt::format(" · AM type {} (0x{:02x})", value, value);
  }
  if (!type.carrier.empty()) out += " · carrier " + html_escaped(type.carrier);
  if (!type.framing.empty()) out += " · framing " + html_escaped(type.framing);
  if (type.name != type.id) out += " · shown as " + html_code(type.name);
  if (!type.requirement.empty()) out += " · " + link_to_requirement(type.requirement);
  if (!type.doc_ref.empty()) out += " · " + html_escaped(type.doc_ref);
  return out + "</p>";
}

}  // namespace

std::string doc_type(const Type& type) {
  std::string body = type.is_mask ? bits_table(type).text()
                                  : doc_layout(type) + "\n" + fields_table(type).text();
  const std::string more = interpretations(type);
  const bool is_root = type.id == type.spec->id;  // Its documentation is the spec's.
  if (!more.empty()) body += "\n" + more;
  return fill(kSection, {{"anchor", anchor_of(type)}, {"name", html_escaped(type.id)},
                         {"doc", type.doc.empty() || is_root ? "" : html_element("p", type.doc)},
                         {"facts", facts(type)}, {"body", body}});
}

std::string doc_enum(const Enum& one) {
  HtmlTable table{"Values of " + one.id, {"name", "value", "hex", "meaning"}, {}, {}};
  for (const EnumEntry& entry : one.entries) {
    table.rows.push_back({html_code(entry.name), std::to_string(entry.value),
                          fmt::format("0x{:02x}", entry.value), html_escaped(entry.doc)});
  }
  return fill(R"(<section id="<<anchor>>">
<h3><<name>></h3>
<<table>>
</section>
)",
              {{"anchor", anchor_of(one)}, {"name", html_escaped(one.id)},
               {"table", table.text()}});
}

}  // namespace rubricc
