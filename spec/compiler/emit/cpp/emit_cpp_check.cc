// Emits TView::check: the rules that bytes can break, in field order.

#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kCheck[] = R"(/// The first rule that `bytes` break, or Fault::kNone.<<doc?>>
static constexpr Error check(Bytes bytes) {
  <<pointer?>>
  <<front?>>
  <<rest?>>
  return no_error();
})";

const char kCheckShort[] = R"(// Bytes that end within the first <<size>>; they may be wrong before.
RUBRIC_COLD static constexpr Error check_short(Bytes bytes) {
  <<steps>>
})";

const char kNested[] = R"(const Error in_<<id>> = <<class>>View::check(<<range>>);
if (RUBRIC_UNLIKELY(is_error(in_<<id>>))) return moved(in_<<id>>, <<at>>);
)";

const char kElements[] = R"(for (size_t i = 0; i < <<bytes>>; i += <<unit>>) {
  <<each>>
})";

const char kChoose[] = R"(Error in_<<id>> = no_error();
switch (<<key>>) {
  <<cases>>
}
if (RUBRIC_UNLIKELY(is_error(in_<<id>>))) return moved(in_<<id>>, <<at>>);
)";

// Returns the check of a number's rule at `at`; empty if it has none.
std::string rule(const Field& f, const std::string& pointer, const std::string& at) {
  if (!has_rule(f)) return "";
  const std::string x = load_integer(f, plus(pointer, at));
  const bool listed = !f.valid->one_of.empty();
  const std::string fault = listed ? "Fault::kUnexpected" : "Fault::kOutOfRange";
  return guard(join(breaches(f, x), listed ? "&&" : "||"),
               "return error_at(" + fault + ", " + at + ", " + cpp_rule(f.requirement) + ");");
}

// The front part. If it can only be too short, one comparison is enough.
struct Front {
  std::string fast;
  std::string slow;  // The body of check_short, empty if not needed.
};
Front front(const Layout& layout) {
  Front out;
  if (layout.front_size == 0) return out;
  std::string slow;
  std::string rules;
  int steps = 0;
  for (std::size_t i = 0; i < layout.leaves.size(); ++i) {
    const FrontLeaf& leaf = layout.leaves[i];
    const Field& f = *leaf.field;
    const std::string checked = rule(f, "p", std::to_string(leaf.offset));
    rules += checked;
    const bool last = i + 1 == layout.leaves.size();
    const bool joins =
        !last && checked.empty() && layout.leaves[i + 1].field->requirement == f.requirement;
    if (joins) continue;
    const std::string short_of = "return truncated(bytes, " + cpp_rule(f.requirement) + ");";
    ++steps;
    if (last) {
      slow += short_of + "\n";
    } else {
      slow += guard("bytes.size() < " + std::to_string(leaf.end), short_of, false) + checked;
      steps += !checked.empty();
    }
  }
  const std::string size = std::to_string(layout.front_size);
  if (steps == 1) {
    slow.pop_back();
    out.fast = guard("bytes.size() < " + size, slow) + rules;
    return out;
  }
  out.fast = guard("bytes.size() < " + size, "return check_short(bytes);") + rules;
  const bool loads = slow.find("(p") != slow.npos;
  out.slow = (loads ? "const uint8_t* const p = bytes.data();\n" : "") + slow;
  return out;
}

Source source_of(const Layout& layout) { return {"p", "bytes.size()", layout.front_size}; }

std::string cases(const Field& f, const Spec& spec, const std::string& range, std::uint32_t most) {
  std::string out;
  const auto check_as = [&](const Type* type) {
    return "  in_" + f.id + " = " + class_of(*type, spec) + "View::check(" +
           limited(range, *type, spec, most) + ");\n  break;\n";
  };
  const auto& all = f.choice->cases;
  for (std::size_t i = 0; i < all.size(); ++i) {
    out += "case " + literal(all[i].key) + ":\n";
    const bool same = i + 1 < all.size() && all[i + 1].type == all[i].type;
    if (!same) out += check_as(all[i].type);
  }
  const auto& otherwise = f.choice->otherwise;
  return out + "default:\n" + (otherwise ? check_as(otherwise->type) : "  break;\n");
}

std::string nested(const Layout& layout, const Field& f, const Spec& spec, const std::string& range,
                   const std::string& at) {
  const std::uint32_t most = most_of(layout, f);
  if (f.choice) {
    return fill(kChoose, {{"id", f.id},
                          {"key", print(*f.choice->key, loads_from(source_of(layout)))},
                          {"cases", cases(f, spec, range, most)},
                          {"at", at}});
  }
  return fill(kNested, {{"id", f.id},
                        {"class", class_of(*f.type, spec)},
                        {"range", limited(range, *f.type, spec, most)},
                        {"at", at}});
}

// Checks one field after the front part. `at` is its offset; the size that it takes goes to `size`.
std::string array_rest(const FieldLayout& l, const Spec& spec, const std::string& at,
                       const std::string& size) {
  const Field& f = *l.field;
  std::string each;
  const std::string place = (at == "0" ? "" : at + " + ") + std::string("i");
  if (l.shape == Shape::kNumbers) {
    each = rule(f, "p", place);
  } else if (!lay_out(*f.type).leaves.empty()) {
    const Layout inner = lay_out(*f.type);
    bool rules = !is_plain(*f.type);
    for (const FrontLeaf& leaf : inner.leaves) rules = rules || has_rule(*leaf.field);
    if (rules) {
      each = fill(kNested, {{"id", f.id},
                            {"class", class_of(*f.type, spec)},
                            {"range", "bytes.sub(" + place + ", " + std::to_string(l.unit) + ")"},
                            {"at", place}});
    }
  }
  if (each.empty()) return "";
  return fill(kElements, {{"bytes", size}, {"unit", std::to_string(l.unit)}, {"each", each}}) +
         "\n";
}

struct Rest {
  std::string text;
  std::string size;  // An expression.
};

// Checks that the bytes that the field delimits are there, and how many they are.
Rest delimited(const FieldLayout& l, const Leaf& loads, const std::string& at, bool more) {
  const Field& f = *l.field;
  const std::string left = at == "0" ? "bytes.size()" : "bytes.size() - " + at;
  Rest out;
  const std::string short_of = "return truncated(bytes, " + cpp_rule(f.requirement) + ");";
  if (f.repeat == RepeatKind::kCount) {
    out.size = print_size(*f.count, loads, l.unit);
  } else if (f.extent == ExtentKind::kSize) {
    out.size = print_size(*f.size, loads);
  } else {
    out.size = left;
  }
  const bool constant = out.size.find('(') == out.size.npos;
  const bool to_end = f.repeat != RepeatKind::kCount && f.extent != ExtentKind::kSize;
  const bool used_again = more || l.shape != Shape::kBytes;
  if (!constant && !to_end && used_again) {
    out.text = "const size_t " + f.id + "_size = " + out.size + ";\n";
    out.size = f.id + "_size";
  }
  if (!to_end) out.text += guard(left + " < " + out.size, short_of);
  const bool array = l.shape == Shape::kNumbers || l.shape == Shape::kStructs;
  if (array && f.repeat == RepeatKind::kToEnd && l.unit > 1) {
    const std::string total = to_end && at != "0" ? "(" + out.size + ")" : out.size;
    const std::string where = to_end ? short_of
                                     : "return error_at(Fault::kTruncated, " + at + " + " +
                                           out.size + ", " + cpp_rule(f.requirement) + ");";
    out.text += guard(total + " % " + std::to_string(l.unit) + " != 0", where);
  }
  return out;
}

Rest rest_of(const Layout& layout, const FieldLayout& l, const Spec& spec, const std::string& at,
             bool more) {
  const Field& f = *l.field;
  const std::string left = at == "0" ? "bytes.size()" : "bytes.size() - " + at;
  const std::string from = at == "0" ? "bytes" : "bytes.from(" + at + ")";
  Rest out;
  if (l.shape == Shape::kNumber) {
    out.size = std::to_string(f.width_bytes);
    out.text = guard(left + " < " + out.size,
                     "return truncated(bytes, " + cpp_rule(f.requirement) + ");") +
               rule(f, "p", at);
    return out;
  }
  if (l.shape == Shape::kNested) {
    out.text = nested(layout, f, spec, from, at);
    out.size = f.type->constant_size() ? std::to_string(f.type->max_size)
                                       : "detail::Access::view<" + class_of(*f.type, spec) +
                                             "View>(" + from + ").size_bytes()";
    return out;
  }
  out = delimited(l, loads_from(source_of(layout)), at, more);
  if (l.shape == Shape::kChoice || l.shape == Shape::kNestedRange) {
    const bool to_end = f.extent == ExtentKind::kToEnd;
    const std::string range = to_end ? from : "bytes.sub(" + at + ", " + out.size + ")";
    out.text += nested(layout, f, spec, range, at);
  } else if (l.shape != Shape::kBytes) {
    out.text += array_rest(l, spec, at, out.size);
  }
  return out;
}

std::string rest(const Layout& layout, const Spec& spec) {
  const Leaf loads = loads_from(source_of(layout));
  std::string out;
  bool running = false;
  for (std::size_t i = layout.front_count; i < layout.fields.size(); ++i) {
    const FieldLayout& l = layout.fields[i];
    const Field& f = *l.field;
    const bool more = i + 1 < layout.fields.size();
    const bool more_moves = more && layout.fields[i + 1].field->fixed_offset < 0;
    std::string at = "at";
    if (f.fixed_offset >= 0) at = std::to_string(f.fixed_offset);
    if (more_moves && !running) {
      out += "size_t at = " + std::to_string(f.fixed_offset) + ";\n";
      running = true;
    }
    Rest one = rest_of(layout, l, spec, running ? "at" : at, more_moves);
    if (more_moves) one.text += "at += " + one.size + ";\n";
    if (f.condition && !one.text.empty()) {
      one.text = fill("if (<<if>>) {\n  <<then>>\n}\n",
                      {{"if", print(*f.condition, loads)}, {"then", one.text}});
    }
    out += one.text;
  }
  return out;
}

}  // namespace

std::string emit_check(const Layout& layout, const Spec& spec) {
  const Front first = front(layout);
  const std::string behind = rest(layout, spec);
  const bool loads = (first.fast + behind).find("(p") != std::string::npos;
  std::string out =
      fill(kCheck, {{"doc", layout.clamps ? " At most kMaxSizeBytes of them." : ""},
                    {"pointer", loads ? "const uint8_t* const p = bytes.data();" : ""},
                    {"front", first.fast},
                    {"rest", behind}});
  if (!first.slow.empty()) {
    out = fill(kCheckShort, {{"size", std::to_string(layout.front_size)}, {"steps", first.slow}}) +
          "\n\n" + out;
  }
  return out;
}

}  // namespace rubricc::cpp
