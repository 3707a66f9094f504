// Emits views: lenses on bytes that parse has checked.
#include <algorithm>
#include <stdexcept>

#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kView[] = R"(class <<class>>Builder;

/// A lens on the bytes of <<name>>; copy it like a pointer. Somebody
/// else owns the bytes; they must outlive it. It exists only where parse found nothing wrong.
class <<class>>View {
 public:
  using Value = <<class>>;
  using Builder = <<class>>Builder;
  static constexpr size_t kMinSizeBytes = <<min>>;
  static constexpr size_t kMaxSizeBytes = <<max>>;
  <<kinds?>>

  /// Checks everything once. <<stale_doc>>
  static constexpr Result<<class_in_angles>> parse(Bytes bytes) {
    <<clamp?>>
    const Error error = check(bytes);
    if (RUBRIC_UNLIKELY(is_error(error))) return Failure{error};
    return <<class>>View(bytes);
  }
  template <size_t kCount>
  static Result<<class_in_angles>> parse(const uint8_t (&&)[kCount]) = delete;  // Dies too early.
  <<check>>

  <<getters?>>

  /// The meant bytes, and how many they are.
  constexpr Bytes bytes() const { return <<meant>>; }
  constexpr size_t size_bytes() const { return <<size>>; }
  /// Bytes that parse was given and that are not part of the structure.
  constexpr Bytes stale() const { return bytes_.from(size_bytes()); }

  <<class>> to_value() const {
    <<class>> value_;
    <<copies?>>
    return value_;
  }

  /// The same meant bytes.
  friend bool operator==(<<class>>View a, <<class>>View b) { return equal(a.bytes(), b.bytes()); }
  friend bool operator!=(<<class>>View a, <<class>>View b) { return !(a == b); }

 private:
  friend struct detail::Access;
  friend class Result<<class_in_angles>>;
  constexpr <<class>>View() = default;
  constexpr explicit <<class>>View(Bytes bytes) : bytes_(bytes) {}
  <<check_short?>>

  Bytes bytes_;
};
)";

const char kGetter[] = R"(<<doc>>
<<constexpr?>><<type>> <<id>>() const {
  <<assert?>>
  return <<value>>;
})";

const char kKind[] = R"(/// <<what>>
enum class <<group>>Kind : uint8_t { <<kinds>> };)";

const char kKindOf[] = R"(<<doc>>
constexpr <<group>>Kind <<name>>_kind() const {
  <<body>>
})";

const char kAs[] = R"(/// Only where <<name>>_kind() is <<kind>>.
constexpr <<class>>View <<name>>_as_<<id>>() const {
  assert(<<name>>_kind() == <<group>>Kind::<<kind>>);
  return detail::Access::view<<view_in_angles>>(<<range>>);
})";

// Prints a view's own getters: they read well, and cost as much as a load.
Leaf from_getters() {
  return [](const Expr& expr) {
    const Field& f = *expr.field;
    if (f.is_instance) {
      const std::string end = std::to_string(expr.offset_bytes + f.width_bytes);
      const std::string at = plus("bytes_.data()", std::to_string(expr.offset_bytes));
      return "(bytes_.size() < " + end + " ? 0 : " + load_integer(f, at) + ")";
    }
    std::string out;
    for (const std::string& step : expr.path) out += (out.empty() ? "" : ".") + step + "()";
    return f.enumeration ? "static_cast<" + raw_type(f) + ">(" + out + ")" : out;
  };
}

SizeText sizes_of(const std::string& bytes, const Leaf& leaf) {
  return [bytes, leaf](const FieldLayout& l) {
    const Field& f = *l.field;
    std::string size = std::to_string(f.width_bytes);
    if (l.shape == Shape::kNested) {
      const bool constant = f.type->constant_size();
      if (!constant && bytes == "out_") {
        throw std::logic_error("emit_cpp: " + f.id + ": fields follow a structure that varies");
      }
      size = constant ? std::to_string(f.type->max_size) : f.id + "().size_bytes()";
    } else if (l.fixed_count) {
      size = std::to_string(l.unit * l.capacity);
    } else if (f.repeat == RepeatKind::kCount) {
      size = print_size(*f.count, leaf, l.unit);
    } else if (f.extent == ExtentKind::kSize) {
      size = print_size(*f.size, leaf);
    }
    if (!f.condition) return size;
    return "(has_" + f.id + "() ? " + size + " : 0)";
  };
}

// Prints an expression for the field's bytes within the view.
std::string range_of(const Layout& layout, std::size_t i) {
  const FieldLayout& l = layout.fields[i];
  const SizeText sizes = sizes_of("bytes_", from_getters());
  const std::string at = offset_of(layout, i, sizes);
  const bool to_end = l.field->repeat != RepeatKind::kCount &&
                      l.field->extent != ExtentKind::kSize && l.shape != Shape::kNumber &&
                      l.shape != Shape::kNested;
  const bool grows = l.shape == Shape::kNested && !l.field->type->constant_size();
  if (to_end || grows) return at == "0" ? "bytes_" : "bytes_.from(" + at + ")";
  return "bytes_.sub(" + at + ", " + sizes(l) + ")";
}

std::string type_of(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  switch (l.shape) {
    case Shape::kNumber: return number_type(f, spec);
    case Shape::kNested: return class_of(*f.type, spec) + "View";
    case Shape::kNumbers: return "NumberArrayView<" + wire_number(f, spec) + ">";
    case Shape::kStructs: return "StructArrayView<" + class_of(*f.type, spec) + "View>";
    default: return "Bytes";
  }
}

std::string getter(const Layout& layout, std::size_t i, const Spec& spec) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  const SizeText sizes = sizes_of("bytes_", from_getters());
  const std::string type = type_of(l, spec);
  std::string value;
  if (l.shape == Shape::kNumber) {
    value = load(f, spec, plus("bytes_.data()", offset_of(layout, i, sizes)));
  } else {
    value = range_of(layout, i);
    if (l.shape == Shape::kNested) value = limited(value, *f.type, spec, most_of(layout, f));
    if (type != "Bytes") value = "detail::Access::view<" + type + ">(" + value + ")";
  }
  std::string out;
  if (f.condition) {
    const Leaf loads = loads_from({"bytes_.data()", "bytes_.size()", layout.front_size});
    out = "/// Whether " + f.id + " is present.\nconstexpr bool has_" + f.id +
          "() const {\n  return " + print(*f.condition, loads) + ";\n}\n";
  }
  const bool constant = f.kind != ValueKind::kFloat || l.shape != Shape::kNumber;
  std::string text = fill(kGetter, {{"doc", field_doc(layout, i)},
                                    {"constexpr", constant ? "constexpr " : ""},
                                    {"type", type},
                                    {"id", f.id},
                                    {"assert", f.condition ? "assert(has_" + f.id + "());" : ""},
                                    {"value", value}});
  const std::string head = (constant ? "constexpr " : "") + type + " " + f.id + "() const {";
  const std::string line = head + " return " + value + "; }";
  if (!f.condition && line.size() <= 98) text = text.substr(0, text.find(head)) + line;
  return out + text + "\n";
}

std::string copy(const FieldLayout& l) {
  const std::string id = l.field->id;
  const bool array = l.shape == Shape::kNumbers || l.shape == Shape::kStructs;
  std::string out;
  if (l.derived_from) return "";
  if (l.shape == Shape::kNested) {
    out = "value_." + id + " = " + id + "().to_value();\n";
  } else if (array && l.fixed_count) {
    out = id + "().copy_to(value_." + id + ", " + std::to_string(l.capacity) + ");\n";
  } else if (array && l.capacity > 0) {
    out = "value_." + id + ".count = static_cast<uint16_t>(\n    " + id + "().copy_to(value_." +
          id + ".items, " + std::to_string(l.capacity) + "));\n";
  } else {
    out = "value_." + id + " = " + id + "();\n";
  }
  return l.field->condition ? "if (has_" + id + "()) " + out : out;
}

// Both kinds of groups end in this comparison of bytes with a type.
std::string pick(const Layout& layout, const Group& group, const Type* type,
                 const std::string& range, const Spec& spec) {
  const std::string kind = pascal(group.name) + "Kind::" + cpp_constant(type->id);
  if (!group.interpretation) return "return " + kind + ";\n";
  const std::string fits = "!is_error(" + class_of(*type, spec) + "View::check(" +
                           limited(range, *type, spec, most_of(layout, *group.overlaid)) + "))";
  const std::string text = guard(fits, "return " + kind + ";", false);
  if (text.size() <= 90) return text;
  return "if (" + fits + ") {\n  return " + kind + ";\n}\n";
}

std::string switch_of(const Layout& layout, const Group& group, const Field& f, const Spec& spec,
                      const std::string& range) {
  if (!f.choice) return pick(layout, group, f.type, range, spec);
  // An interpretation's key may be the first byte of a body that is known not to be empty.
  const std::int64_t safe = group.interpretation ? group.overlaid->fixed_offset + 1 : 0;
  const Leaf loads = loads_from(
      {"bytes_.data()", "bytes_.size()", std::max<std::int64_t>(safe, layout.front_size)});
  std::string out = "switch (" + print(*f.choice->key, loads) + ") {\n";
  const auto add = [&](const Type* type) {
    const std::string text = pick(layout, group, type, range, spec);
    out += "    ";
    for (const char c : text.substr(0, text.size() - 1)) {
      out += c == '\n' ? "\n    " : std::string(1, c);
    }
    out += group.interpretation ? "\n    break;\n" : "\n";
  };
  const auto& all = f.choice->cases;
  for (std::size_t i = 0; i < all.size(); ++i) {
    out += "  case " + literal(all[i].key) + ":\n";
    if (i + 1 == all.size() || all[i + 1].type != all[i].type) add(all[i].type);
  }
  out += "  default:\n";
  if (f.choice->otherwise) {
    add(f.choice->otherwise->type);
  } else {
    out += group.interpretation ? "    break;\n"
                                : "    return " + pascal(group.name) + "Kind::kOpaque;\n";
  }
  return out + "}\n";
}

std::string kind_body(const Layout& layout, const Group& group, const Spec& spec,
                      const std::string& range) {
  const std::string opaque = "return " + pascal(group.name) + "Kind::kOpaque;\n";
  if (!group.interpretation) return switch_of(layout, group, *group.fields[0], spec, range);
  std::string out = "const Bytes body = " + range + ";\n";
  std::string last_condition;
  std::string open;
  const Leaf loads = loads_from({"bytes_.data()", "bytes_.size()", layout.front_size});
  const auto close = [&] {
    if (open.empty()) return;
    out += last_condition.empty()
               ? open
               : fill("if (<<if>>) {\n  <<then>>\n}\n", {{"if", last_condition}, {"then", open}});
    open.clear();
  };
  for (const Field* f : group.fields) {
    std::string condition = f->condition ? print(*f->condition, loads) : "";
    // The key of a body without bytes is not there.
    if (f->choice) condition += (condition.empty() ? "" : " && ") + std::string("!body.empty()");
    if (condition != last_condition) close();
    last_condition = condition;
    open += switch_of(layout, group, *f, spec, "body");
  }
  close();
  return out + opaque;
}

}  // namespace

// Views take all bytes that they are given, so these must not be more than they may have.
std::string limited(const std::string& range, const Type& type, const Spec& spec,
                    std::uint32_t most) {
  const Layout inner = lay_out(type);
  if (!inner.clamps || most <= type.max_size) return range;
  return "at_most(" + range + ", " + class_of(type, spec) + "View::kMaxSizeBytes)";
}

std::uint32_t most_of(const Layout& layout, const Field& f) {
  if (!is_unbounded(f.max_size) && f.max_size > 0) return f.max_size;
  if (is_unbounded(layout.type->max_size) || f.fixed_offset < 0) return UINT32_MAX;
  return layout.type->max_size - static_cast<std::uint32_t>(f.fixed_offset);
}

SizeText builder_sizes() {
  return sizes_of("out_", loads_from({"out_.data()", "out_.size()", INT32_MAX}));
}

std::string emit_group(const Layout& layout, const Group& group, const Spec& spec) {
  // kind_body() has a variable of that name.
  const std::string& id = group.overlaid->id;
  const std::string range = (id == "body" ? "this->" : "") + id + "()";
  const std::string name = pascal(group.name);
  const std::string doc =
      group.interpretation
          ? "What the bytes of " + group.overlaid->id +
                " mean: the first interpretation that they fit; kOpaque if they fit none. It "
                "checks them; ask once."
          : "What " + group.overlaid->id + " holds; parse has checked it. kOpaque: no rule.";
  std::string out = fill(kKindOf, {{"doc", comment(doc)},
                                   {"group", name},
                                   {"name", group.name},
                                   {"body", kind_body(layout, group, spec, range)}}) +
                    "\n";
  for (const Type* type : group.types) {
    out += fill(kAs, {{"name", group.name},
                      {"kind", cpp_constant(type->id)},
                      {"class", class_of(*type, spec)},
                      {"id", type->id},
                      {"group", name},
                      {"view_in_angles", angles(class_of(*type, spec) + "View")},
                      {"range", limited(range, *type, spec, most_of(layout, *group.overlaid))}}) +
           "\n";
  }
  return out;
}

std::string emit_view(const Layout& layout, const Spec& spec) {
  const Type& type = *layout.type;
  const std::string name = pascal(type.id);
  std::string getters;
  std::string copies;
  std::string kinds;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    getters += getter(layout, i, spec);
    copies += copy(layout.fields[i]);
  }
  for (const Group& group : layout.groups) {
    getters += "\n" + emit_group(layout, group, spec);
    std::vector<std::string> names{"kOpaque"};
    for (const Type* t : group.types) names.push_back(cpp_constant(t->id));
    kinds += fill(kKind, {{"what", "What the bytes of " + group.overlaid->id + " may hold."},
                          {"group", pascal(group.name)},
                          {"kinds", join(names, ",")}}) +
             "\n";
  }
  std::string check = emit_check(layout, spec);
  std::string check_short;
  const std::size_t split = check.find("\n\n");
  if (check.starts_with("// Bytes that end")) {
    check_short = check.substr(0, split);
    check = check.substr(split + 2);
  }
  const bool all = layout.has_tail;
  const std::string size = total_of(layout, sizes_of("bytes_", from_getters()));
  const bool exact = all && !layout.clamps;
  return fill(kView,
              {{"name", type.name},
               {"class", name},
               {"class_in_angles", angles(name + "View")},
               {"min", std::to_string(type.min_size)},
               {"max", is_unbounded(type.max_size) ? "SIZE_MAX" : std::to_string(type.max_size)},
               {"kinds", kinds},
               {"stale_doc", exact ? "All bytes are part of it."
                             : all ? "Bytes after the greatest size are left out."
                                   : "Bytes after the structure are stale()."},
               {"clamp", layout.clamps ? "bytes = at_most(bytes, kMaxSizeBytes);" : ""},
               {"check", check},
               {"getters", getters},
               {"meant", all ? "bytes_" : "bytes_.first(size_bytes())"},
               {"size", all ? "bytes_.size()" : size},
               {"copies", copies},
               {"check_short", check_short}});
}

std::string field_doc(const Layout& layout, std::size_t i) {
  const Field& f = *layout.fields[i].field;
  std::string text = range_text(layout, i) + ". " + f.doc;
  if (f.unit) {
    text += (f.doc.empty() || f.doc.back() == '.') ? " Unit: " + f.unit->symbol + "." : "";
  }
  if (has_rule(f) && f.valid->one_of.empty()) {
    text += " From " + std::to_string(f.range.min) + " to " + std::to_string(f.range.max) + ".";
  }
  if (!f.requirement.empty() && f.requirement != layout.type->requirement) {
    text += " " + f.requirement + ".";
  }
  return comment(text);
}

}  // namespace rubricc::cpp
