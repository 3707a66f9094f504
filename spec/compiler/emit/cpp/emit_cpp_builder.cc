// Emits builders, which write a structure in place, field by field.
#include <algorithm>

#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kBuilder[] = R"(/// Writes <<name>> in place. What is not set keeps what `out` held.
/// A setter that can refuse its value returns whether it took it.
class <<class>>Builder {
 public:
  constexpr <<class>>Builder() = default;
  /// kNoRoom where `out` is smaller than kMinSizeBytes of the view.
  static constexpr Result<<builder_in_angles>> create(MutableBytes out) {
    <<room?>>
    return <<class>>Builder(out);
  }

  <<setters?>>

  /// Checks the whole, as parse does; the view is exactly as large as the structure.
  Result<<view_in_angles>> finish() const {
    <<size?>>
    const Result<<view_in_angles>> whole = <<class>>View::parse(<<written>>);
    if (!whole) return whole;
    return detail::Access::view<<view_in_angles>>(whole->bytes());
  }

 private:
  friend struct detail::Access;
  constexpr explicit <<class>>Builder(MutableBytes out) : out_(out) {}

  <<present?>>

  MutableBytes out_;
  <<tail_member?>>
};
)";

const char kSetter[] = R"(void set_<<id>>(<<type>> value) { <<store>> })";
const char kCheckedSetter[] = R"(RUBRIC_MUST_USE bool set_<<id>>(<<type>> value) {
  <<checks>>
  <<store>>
  return true;
})";
const char kPlainSet[] = R"(void set_<<id>>(const <<class>>& value) {
  <<class>>Layout::store(value, <<at>>);
})";
const char kRoom[] = R"(/// Where <<id>> goes: all the room that there is.
MutableBytes <<id>>_room() {
  <<room>>
})";
const char kSetBytes[] = R"(/// Copies <<id>><<and>>; false where there is no room.
RUBRIC_MUST_USE bool set_<<id>>(Bytes value) {
  <<checks>>
  detail::store_bytes(<<at>>, value);
  return true;
})";
const char kTailSize[] = R"(/// The first `size` bytes of <<id>>_room() are it; false: no room.
RUBRIC_MUST_USE bool set_<<id>>_size(size_t size) {
  if (size > <<id>>_room().size()<<limit?>>) return false;
  tail_ = size;
  return true;
})";
const char kSetNumbers[] = R"(/// Copies `n` elements<<and?>>; false where there is no room.
RUBRIC_MUST_USE bool set_<<id>>(const <<type>>* from, size_t n) {
  <<checks>>
  detail::store_numbers<<number_in_angles>>(<<at>>, from, n);
  return true;
})";
const char kSetElement[] = R"(/// Element `i`, which must be there.
void set_<<id>>(size_t i, <<type>> value) {
  assert(<<there>>);
  <<store>>
})";
const char kElement[] = R"(/// Element `i`, which must be there.
<<class>>Builder <<id>>(size_t i) {
  assert(<<there>>);
  return detail::Access::builder<<builder_in_angles>>(<<range>>);
})";

struct Context {
  const Layout& layout;
  const Spec& spec;
  SizeText sizes;

  std::string at(std::size_t i) const { return offset_of(layout, i, sizes); }
  // create() has found room for it.
  bool is_sure(std::size_t i) const {
    const Field& f = *layout.fields[i].field;
    return f.fixed_offset >= 0 && !f.condition &&
           static_cast<std::uint64_t>(f.fixed_offset) + f.min_size <= layout.type->min_size;
  }
};

std::string refuse(const std::string& condition) {
  return guard(condition, "return false;", false);
}

// Returns the condition that `value` is outside of the field's range.
std::string rule(const Field& f) {
  if (!has_rule(f)) return "";
  const std::string x =
      f.enumeration ? "static_cast<" + raw_type(f) + ">(value)" : std::string("value");
  return refuse(join(breaches(f, x), f.valid->one_of.empty() ? "||" : "&&"));
}

std::string number(const Context& c, std::size_t i) {
  const FieldLayout& l = c.layout.fields[i];
  const Field& f = *l.field;
  std::string checks = rule(f);
  if (!c.is_sure(i)) {
    checks += refuse("out_.size() < " + c.at(i) + " + " + std::to_string(f.width_bytes));
  }
  if (l.derived_from) {
    const auto is_it = [&](const FieldLayout& o) { return o.field == l.derived_from; };
    const auto holder = std::find_if(c.layout.fields.begin(), c.layout.fields.end(), is_it);
    const std::string at = c.at(static_cast<std::size_t>(holder - c.layout.fields.begin()));
    // For elements of one byte the least size is as good as the room.
    const std::string size =
        holder->unit == 1 ? "value" : "size_t{value} * " + std::to_string(holder->unit);
    checks += refuse(size + " > out_.size() - " + (at.find(' ') == at.npos ? at : "(" + at + ")"));
  }
  const std::string put = store(f, plus("out_.data()", c.at(i)), "value");
  const Holes holes{{"id", f.id}, {"type", number_type(f, c.spec)}, {"store", put}};
  if (!checks.empty()) {
    Holes more = holes;
    more.emplace_back("checks", checks);
    return fill(kCheckedSetter, more);
  }
  const std::string line = fill(kSetter, holes);
  if (line.size() <= 98) return line;
  return fill("void set_<<id>>(<<type>> value) {\n  <<store>>\n}", holes);
}

std::string nested(const Context& c, std::size_t i) {
  const Field& f = *c.layout.fields[i].field;
  const std::string type = class_of(*f.type, c.spec);
  const std::string at = c.at(i);
  const bool constant = f.type->constant_size();
  std::string set;
  if (is_plain(*f.type) && !has_lengths(*f.type)) {
    set = fill(kPlainSet, {{"id", f.id}, {"class", type}, {"at", plus("out_.data()", at)}});
  }
  const std::string range = constant ? "out_.sub(" + at + ", " + std::to_string(f.max_size) + ")"
                                     : "out_.from(" + at + ")";
  std::string out = fill(
      "<<class>>Builder <<id>>() {\n"
      "  return detail::Access::builder<<builder_in_angles>>(<<range>>);\n}",
      {{"class", type},
       {"id", f.id},
       {"builder_in_angles", angles(type + "Builder")},
       {"range", range}});
  return set.empty() ? out : out + "\n" + set;
}

std::string payload(const Context& c, std::size_t i) {
  const FieldLayout& l = c.layout.fields[i];
  const Field& f = *l.field;
  const std::string at = c.at(i);
  const std::string left = at == "0" ? "out_" : "out_.from(" + at + ")";
  const bool tail = f.extent == ExtentKind::kToEnd;
  std::uint32_t most = f.max_size;
  if (is_unbounded(most) && !is_unbounded(c.layout.type->max_size) && f.fixed_offset >= 0) {
    most = c.layout.type->max_size - static_cast<std::uint32_t>(f.fixed_offset);
  }
  std::string room = "return " + left + ";";
  if (!c.is_sure(i)) room = "if (out_.size() < " + at + ") return MutableBytes();\n" + room;
  std::string out = fill(kRoom, {{"id", f.id}, {"room", room}}) + "\n";
  std::string checks = refuse("value.size() > " + f.id + "_room().size()");
  const std::string limit = " > " + std::to_string(most);
  if (!is_unbounded(most)) checks += refuse("value.size()" + limit);
  std::string also = " (its length is set elsewhere)";
  if (l.length) {
    checks += refuse("!set_" + l.length->id + "(static_cast<" + number_type(*l.length, c.spec) +
                     ">(value.size()))");
    also = " and sets " + l.length->id;
  } else if (tail) {
    checks += "tail_ = value.size();\n";
    also = " and its size";
    out +=
        fill(kTailSize, {{"id", f.id}, {"limit", is_unbounded(most) ? "" : " || size" + limit}}) +
        "\n";
  }
  return out +
         fill(kSetBytes,
              {{"id", f.id}, {"and", also}, {"checks", checks}, {"at", plus("out_.data()", at)}});
}

// Checks that `n` elements fit; sets the field that holds their number.
std::string count_checks(const Context& c, std::size_t i) {
  const FieldLayout& l = c.layout.fields[i];
  const Field& f = *l.field;
  const std::string at = c.at(i);
  if (l.fixed_count) return refuse("n > " + std::to_string(l.capacity));
  std::string out;
  if (l.capacity > 0) out += refuse("n > " + std::to_string(l.capacity));
  if (l.length) {
    return out + refuse("!set_" + l.length->id + "(static_cast<" + number_type(*l.length, c.spec) +
                        ">(n))");
  }
  out += refuse("n > (out_.size() - (" + at + ")) / " + std::to_string(l.unit));
  if (f.repeat == RepeatKind::kToEnd && f.extent == ExtentKind::kOwn) {
    out += "tail_ = n * " + std::to_string(l.unit) + ";\n";
  }
  if (f.extent == ExtentKind::kToEnd) out += "tail_ = n * " + std::to_string(l.unit) + ";\n";
  return out;
}

std::string array(const Context& c, std::size_t i) {
  const FieldLayout& l = c.layout.fields[i];
  const Field& f = *l.field;
  const std::string at = c.at(i);
  const std::string unit = std::to_string(l.unit);
  const std::string element = at + " + i" + (l.unit == 1 ? "" : " * " + unit);
  const std::string room = at + " + (i + 1) * " + unit + " <= out_.size()";
  const std::string there = l.fixed_count ? "i < " + std::to_string(l.capacity) : room;
  if (l.shape == Shape::kNumbers) {
    const std::string type = number_type(f, c.spec);
    std::string out = fill(kSetNumbers, {{"id", f.id},
                                         {"and", l.length ? " and sets " + l.length->id : ""},
                                         {"type", type},
                                         {"checks", count_checks(c, i)},
                                         {"number_in_angles", angles(wire_number(f, c.spec))},
                                         {"at", plus("out_.data()", at)}});
    return out + "\n" +
           fill(kSetElement, {{"id", f.id},
                              {"type", type},
                              {"there", there},
                              {"store", store(f, "out_.data() + " + element, "value")}});
  }
  const std::string type = class_of(*f.type, c.spec);
  return fill(kElement, {{"class", type},
                         {"id", f.id},
                         {"there", there},
                         {"builder_in_angles", angles(type + "Builder")},
                         {"range", "out_.sub(" + element + ", " + unit + ")"}});
}

std::string setter(const Context& c, std::size_t i) {
  switch (c.layout.fields[i].shape) {
    case Shape::kNumber: return number(c, i);
    case Shape::kNested: return nested(c, i);
    case Shape::kNumbers:
    case Shape::kStructs: return array(c, i);
    default: return payload(c, i);
  }
}

}  // namespace

std::string emit_builder(const Layout& layout, const Spec& spec) {
  const Type& type = *layout.type;
  const std::string name = pascal(type.id);
  const Context context{layout, spec, builder_sizes()};
  std::string setters;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    setters += field_doc(layout, i) + setter(context, i) + "\n";
  }
  const std::string room =
      guard("out.size() < " + name + "View::kMinSizeBytes",
            "return fail(Fault::kNoRoom, out.size(), " + cpp_rule(type.requirement) + ");");
  std::string written = "out_";
  std::string size;
  std::string present;
  for (const FieldLayout& l : layout.fields) {
    if (!l.field->condition) continue;
    const Leaf loads = loads_from({"out_.data()", "out_.size()", layout.front_size});
    present += "bool has_" + l.field->id + "() const {\n  return " +
               print(*l.field->condition, loads) + ";\n}\n";
  }
  const bool tail = setters.find("tail_") != std::string::npos;
  if (tail) {
    written = "out_.first(size)";
    const std::string before = context.at(layout.fields.size() - 1);
    size = "const size_t size = " + (before == "0" ? "" : before + " + ") + "tail_;\n" +
           guard("out_.size() < size",
                 "return fail(Fault::kNoRoom, out_.size(), " + cpp_rule(type.requirement) + ");");
  }
  return fill(kBuilder, {{"name", type.name},
                         {"class", name},
                         {"builder_in_angles", angles(name + "Builder")},
                         {"view_in_angles", angles(name + "View")},
                         {"room", type.min_size == 0 ? "" : room},
                         {"setters", setters},
                         {"size", size},
                         {"present", present},
                         {"written", written},
                         {"tail_member", tail ? "size_t tail_ = 0;  // Bytes." : ""}});
}

}  // namespace rubricc::cpp
