// Emits values: plain structures, and how they are written.
#include <algorithm>
#include <stdexcept>

#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kValue[] = R"(<<doc>>
struct <<class>> {
  <<members?>>
};
inline bool operator==(const <<class>>& a, const <<class>>& b) {
  return <<same>>;
}
inline bool operator!=(const <<class>>& a, const <<class>>& b) { return !(a == b); }
)";

const char kLayout[] =
    R"(/// Where <<name>> has its fields, and the steps of writing it; use write().
struct <<class>>Layout {
  <<places?>>
  <<present?>>
  static size_t size_bytes(const <<class>>&<<size_param?>>) { return <<size>>; }
  <<check?>>
  static void store(const <<class>>&<<store_param?>>, uint8_t*<<p_param?>>) {
    <<stores?>>
  }
};
)";

const char kCheckLengths[] = R"(static Error check_lengths(const <<class>>& value) {
  <<checks>>
  return no_error();
})";

const char kWrite[] = R"(/// Writes `value` and returns the bytes written. Refuses what parse
/// would refuse, with the same fault, and an `out` that is too small (kNoRoom); what `out` then
/// holds is undefined.
inline Result<MutableBytes> write(const <<class>>& value, MutableBytes out) {
  <<lengths?>>
  const size_t size = <<class>>Layout::size_bytes(value);
  if (RUBRIC_UNLIKELY(out.size() < size)) {
    return fail(Fault::kNoRoom, out.size(), <<requirement>>);
  }
  <<class>>Layout::store(value, out.data());
  <<verify?>>
  return out.first(size);
}
)";

const char kWriteLengths[] = R"(const Error wrong = <<class>>Layout::check_lengths(value);
if (RUBRIC_UNLIKELY(is_error(wrong))) return Failure{wrong};)";

const char kWriteVerify[] = R"(const Error error = <<class>>View::check(out.first(size));
if (RUBRIC_UNLIKELY(is_error(error))) return Failure{error};)";

bool is_bytes(const FieldLayout& l) {
  return l.shape == Shape::kBytes || l.shape == Shape::kChoice || l.shape == Shape::kNestedRange;
}
bool is_array(const FieldLayout& l) {
  return l.shape == Shape::kNumbers || l.shape == Shape::kStructs;
}

std::string value_of(const Field& f) { return "value." + f.id; }

std::string length_text(const Field& holder) { return value_of(holder) + ".size()"; }

// Prints fields of expressions as members of `value`.
Leaf value_leaf(const Layout& layout) {
  return [&layout](const Expr& expr) {
    if (expr.field->is_instance) {
      throw std::logic_error("emit_cpp: " + expr.field->id + ": a length reads an instance");
    }
    const std::size_t depth = expr.steps.size();
    std::string out = "value";
    for (std::size_t i = 0; i + 1 < depth; ++i) out += "." + expr.path[i];
    const Layout inner = depth > 1 ? lay_out(*expr.steps[depth - 2]->type) : Layout{};
    for (const FieldLayout& l : (depth > 1 ? inner : layout).fields) {
      if (l.field != expr.field || !l.derived_from) continue;
      return out + "." + l.derived_from->id + ".size()";
    }
    out += "." + expr.path.back();
    if (expr.field->kind == ValueKind::kMask) return out + ".raw()";
    return expr.field->enumeration ? "static_cast<" + raw_type(*expr.field) + ">(" + out + ")"
                                   : out;
  };
}

SizeText value_sizes(const Spec& spec) {
  return [&spec](const FieldLayout& l) {
    const Field& f = *l.field;
    std::string size = std::to_string(f.width_bytes);
    if (l.shape == Shape::kNested) {
      size = f.type->constant_size()
                 ? std::to_string(f.type->max_size)
                 : class_of(*f.type, spec) + "Layout::size_bytes(" + value_of(f) + ")";
    } else if (is_bytes(l)) {
      size = value_of(f) + ".size()";
    } else if (is_array(l)) {
      size = l.fixed_count
                 ? std::to_string(f.max_size)
                 : value_of(f) + ".size()" + (l.unit == 1 ? "" : " * " + std::to_string(l.unit));
    }
    if (!f.condition) return size;
    return "(has_" + f.id + "(value) ? " + size + " : 0)";
  };
}

std::string member_type(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  if (is_bytes(l)) return "Bytes";
  const std::string element =
      f.kind == ValueKind::kStruct ? class_of(*f.type, spec) : number_type(f, spec);
  if (!is_array(l) || l.fixed_count) return element;
  if (l.capacity > 0) return "Array<" + element + ", " + std::to_string(l.capacity) + ">";
  return l.shape == Shape::kNumbers ? "NumberArrayView<" + wire_number(f, spec) + ">"
                                    : "StructArrayView<" + element + "View>";
}

std::string member(const Layout& layout, std::size_t i, const Spec& spec) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  const std::string type = member_type(l, spec);
  std::string initial;
  if (is_array(l) && l.fixed_count) {
    initial = "[" + std::to_string(l.capacity) + "] = {}";
  } else if (l.shape == Shape::kNumber) {
    const bool made = f.kind == ValueKind::kMask || f.enumeration;
    initial = made ? " = " + type + "()" : " = 0";
  }
  return field_doc(layout, i) + type + " " + f.id + initial + ";\n";
}

bool needs_length_check(const FieldLayout& l) {
  if (l.derived_from) return true;
  if (l.shape == Shape::kNested) return has_lengths(*l.field->type);
  if (l.length || (is_array(l) && l.fixed_count)) {
    return l.shape == Shape::kStructs && has_lengths(*l.field->type);
  }
  const bool sized = l.field->extent == ExtentKind::kSize;
  if (!is_array(l)) return is_bytes(l) && sized;
  return l.capacity > 0 || sized || l.field->repeat == RepeatKind::kCount ||
         (l.shape == Shape::kStructs && has_lengths(*l.field->type));
}

std::string derived_check(const FieldLayout& l) {
  const Field& f = *l.field;
  const std::string size = length_text(*l.derived_from);
  std::vector<std::string> outside;
  if (f.range.min > 0) outside.push_back(size + " < " + literal(f.range.min));
  outside.push_back(size + " > " + literal(f.range.max));
  return guard(join(outside, "||"), "return error_at(Fault::kOutOfRange, " +
                                        std::to_string(f.fixed_offset) + ", " +
                                        cpp_rule(f.requirement) + ");");
}

std::string length_check(const Layout& layout, std::size_t i, const Spec& spec) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  if (l.derived_from) return derived_check(l);
  const std::string offset = offset_of(layout, i, value_sizes(spec));
  const std::string have = length_text(f);
  std::string out;
  if (l.shape == Shape::kNested) {
    return "const Error in_" + f.id + " = " + class_of(*f.type, spec) + "Layout::check_lengths(" +
           value_of(f) + ");\n" +
           guard("is_error(in_" + f.id + ")", "return moved(in_" + f.id + ", " + offset + ");");
  }
  const Expr* want = f.repeat == RepeatKind::kCount  ? f.count.get()
                     : f.extent == ExtentKind::kSize ? f.size.get()
                                                     : nullptr;
  if (is_array(l) && !l.fixed_count && l.capacity > 0 && !l.length) {
    out += guard(have + " > " + std::to_string(l.capacity),
                 "return error_at(Fault::kTooLong, " + offset + " + " +
                     std::to_string(l.capacity * l.unit) + ", " + cpp_rule(f.requirement) + ");");
  }
  if (want && !l.length && !l.fixed_count) {
    std::string count = print_size(*want, value_leaf(layout));
    if (is_array(l) && f.repeat != RepeatKind::kCount) count += " / " + std::to_string(l.unit);
    out += "const size_t " + f.id + "_size = " + count + ";\n" +
           guard(have + " != " + f.id + "_size", "return wrong_length(" + have + ", " + f.id +
                                                     "_size, " + offset + ", " +
                                                     cpp_rule(f.requirement) + ");");
  }
  if (l.shape == Shape::kStructs && has_lengths(*f.type)) {
    const std::string count = l.fixed_count ? std::to_string(l.capacity) : have;
    out += "for (size_t i = 0; i < " + count +
           "; ++i) {\n  const Error error = " + class_of(*f.type, spec) + "Layout::check_lengths(" +
           value_of(f) + "[i]);\n  if (is_error(error)) return moved(error, " + offset + " + i * " +
           std::to_string(l.unit) + ");\n}\n";
  }
  return out;
}

std::string optional(const Field& f, const std::string& text) {
  if (!f.condition || text.empty()) return text;
  return fill("if (<<if>>) {\n  <<then>>\n}\n",
              {{"if", "has_" + f.id + "(value)"}, {"then", text}});
}

std::string length_checks(const Layout& layout, const Spec& spec) {
  std::string out;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    if (!needs_length_check(layout.fields[i])) continue;
    out += optional(*layout.fields[i].field, length_check(layout, i, spec));
  }
  const FieldLayout* last = layout.fields.empty() ? nullptr : &layout.fields.back();
  if (layout.clamps && (!is_array(*last) || last->capacity == 0)) {
    const std::string most = std::to_string(layout.type->max_size);
    out += guard("size_bytes(value) > " + most, "return error_at(Fault::kTooLong, " + most + ", " +
                                                    cpp_rule(last->field->requirement) + ");");
  }
  return out;
}

std::string store_field(const Layout& layout, std::size_t i, const Spec& spec) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  const std::string at = plus("p", offset_of(layout, i, value_sizes(spec)));
  const std::string value = value_of(f);
  if (l.derived_from) {
    return store(f, at, "static_cast<" + raw_type(f) + ">(" + length_text(*l.derived_from) + ")") +
           "\n";
  }
  if (l.shape == Shape::kNumber) return store(f, at, value) + "\n";
  if (l.shape == Shape::kNested) {
    return class_of(*f.type, spec) + "Layout::store(" + value + ", " + at + ");\n";
  }
  if (is_bytes(l)) return "detail::store_bytes(" + at + ", " + value + ");\n";
  if (!l.fixed_count && l.capacity == 0) {
    return "detail::store_bytes(" + at + ", " + value + ".bytes());\n";
  }
  const std::string count = l.fixed_count ? std::to_string(l.capacity) : length_text(f);
  const std::string items = l.fixed_count ? value : value + ".items";
  if (l.shape == Shape::kNumbers) {
    return "detail::store_numbers<" + wire_number(f, spec) + ">(" + at + ", " + items + ", " +
           count + ");\n";
  }
  return "for (size_t i = 0; i < " + count + "; ++i) {\n  " + class_of(*f.type, spec) +
         "Layout::store(" + items + "[i], " + at + " + i * " + std::to_string(l.unit) + ");\n}\n";
}

// Names the type that says where a field is, and what number it holds; nothing if the place varies.
std::string place(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  if (f.fixed_offset < 0) return "";
  const std::string at = std::to_string(f.fixed_offset);
  std::string type = "PlaceAt<" + at + ">";
  if (l.shape == Shape::kNumbers) type = "ArrayAt<" + at + ", " + wire_number(f, spec) + ">";
  if (l.shape == Shape::kNumber) {
    type = "NumberAt<" + at + ", " + wire_number(f, spec) + ">";
    if (has_rule(f) && f.valid->one_of.size() < 2) {
      type = "RangedAt<" + at + ", " + wire_number(f, spec) + ", " + literal(f.range.min) + ", " +
             literal(f.range.max) + ">";
    }
  }
  return "using " + pascal(f.id) + "At = " + type + ";\n";
}

// Returns whether the bytes can still break a rule once the lengths are right.
bool needs_verify(const Layout& layout) {
  const auto leaf_rule = [&](const FrontLeaf& leaf) {
    const auto derived = [&](const FieldLayout& l) {
      return l.field == leaf.field && l.derived_from && l.field->valid->one_of.empty();
    };
    return has_rule(*leaf.field) &&
           std::none_of(layout.fields.begin(), layout.fields.end(), derived);
  };
  const auto field_rule = [](const FieldLayout& l) {
    if (l.front) return false;
    if (l.shape == Shape::kChoice || l.shape == Shape::kNestedRange || has_rule(*l.field)) {
      return true;
    }
    const bool structure = l.shape == Shape::kNested || l.shape == Shape::kStructs;
    return structure && (!is_plain(*l.field->type) || needs_verify(lay_out(*l.field->type)));
  };
  return std::any_of(layout.leaves.begin(), layout.leaves.end(), leaf_rule) ||
         std::any_of(layout.fields.begin(), layout.fields.end(), field_rule);
}

}  // namespace

bool has_lengths(const Type& type) {
  const Layout layout = lay_out(type);
  if (layout.clamps) return true;
  return std::any_of(layout.fields.begin(), layout.fields.end(), needs_length_check);
}

std::string emit_value(const Layout& layout, const Spec& spec) {
  const Type& type = *layout.type;
  const std::string name = pascal(type.id);
  std::string members;
  std::string derived;
  std::string places;
  std::string stores;
  std::string present;
  std::vector<std::string> same;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const Field& f = *layout.fields[i].field;
    stores += optional(f, store_field(layout, i, spec));
    places += place(layout.fields[i], spec);
    if (const Field* holder = layout.fields[i].derived_from) {
      derived += " " + f.id + " is the size of " + holder->id + ".";
      continue;
    }
    members += member(layout, i, spec);
    if (f.condition) {
      present += "static bool has_" + f.id + "(const " + name + "& value) {\n  return " +
                 print(*f.condition, value_leaf(layout)) + ";\n}\n";
    }
    same.push_back("detail::same(a." + f.id + ", b." + f.id + ")");
  }
  const std::string size = total_of(layout, value_sizes(spec));
  const bool uses_value = size.find("value") != std::string::npos;
  std::string check;
  if (has_lengths(type)) {
    check = fill(kCheckLengths, {{"class", name}, {"checks", length_checks(layout, spec)}});
  }
  std::string doc = type.name + " as a value.";
  if (members.find("Bytes ") != members.npos) doc += " Its bytes are borrowed.";
  return fill(kValue, {{"class", name},
                       {"doc", comment(doc + derived)},
                       {"members", members},
                       {"same", same.empty() ? "true" : join(same, "&&")}}) +
         "\n" +
         fill(kLayout, {{"name", type.name},
                        {"class", name},
                        {"places", places},
                        {"present", present},
                        {"size_param", uses_value ? " value" : ""},
                        {"size", size},
                        {"check", check},
                        {"store_param", stores.find("value.") != stores.npos ? " value" : ""},
                        {"p_param", stores.empty() ? "" : " p"},
                        {"stores", stores}});
}

std::string emit_write(const Layout& layout, const Spec&) {
  const Type& type = *layout.type;
  const std::string name = pascal(type.id);
  const std::string lengths = has_lengths(type) ? fill(kWriteLengths, {{"class", name}}) : "";
  const std::string verify = needs_verify(layout) ? fill(kWriteVerify, {{"class", name}}) : "";
  return fill(kWrite, {{"class", name},
                       {"lengths", lengths},
                       {"requirement", cpp_rule(type.requirement)},
                       {"verify", verify}});
}

}  // namespace rubricc::cpp
