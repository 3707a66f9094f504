// Emits the reading half of a class: the rules that bytes can break, and the getters.
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/java/emit_java_text.h"

namespace rubricc::java {
namespace {

const char kGetter[] = R"(<<doc>>
public <<type>> <<name>>() {
  <<absent?>>
  <<body>>
}
)";

const char kNumbers[] = R"(final <<type>>[] out = new <<type>>[<<count>>];
for (int i = 0; i < out.length; ++i) out[i] = Wire.<<wire>>(bytes, <<at?>>i * <<unit>>);
return out;
)";

const char kStructs[] = R"(final List<<element>> out = new ArrayList<>();
for (int i = 0; i < <<count>>; ++i) {
  out.add(new <<class>>(part(range(<<at?>>i * <<unit>>, <<unit>>))));
}
return out;
)";

const char kSwitch[] = R"(switch (<<key>>) {
  <<cases>>
}
)";

const char kInterpretations[] = R"(final ByteBuffer held = <<overlaid>>();
WireView view = null;
<<tries>>
return view;
)";

const char kRest[] = R"(@Override
public int sizeBytes() {
  return <<size>>;
}

@Override
public void fields(BiConsumer<String, Object> visitor) {
  <<visits>>
}
)";

std::string rule(const Field& f) {
  if (!cpp::has_rule(f)) return "";
  if (f.valid->one_of.empty()) {
    return ".isFrom(" + literal(f.range.min) + ", " + literal(f.range.max) + ")";
  }
  std::string values;
  for (const std::int64_t good : f.valid->one_of) {
    values += (values.empty() ? "" : ", ") + literal(good);
  }
  return ".isOneOf(" + values + ")";
}

std::string take(const std::string& in, const Field& f) {
  return in + "." + wire_name(f) + "(" + quote(f.requirement) + ")" + rule(f) + ";\n";
}

bool ends_with_bytes(const Field& f) {
  return f.repeat != RepeatKind::kCount && f.extent != ExtentKind::kSize;
}

// Returns the number of bytes that the field delimits itself.
std::string delimited(const FieldLayout& l, const Leaf& leaf) {
  const Field& f = *l.field;
  if (f.repeat == RepeatKind::kCount) return print_size(*f.count, leaf, l.unit);
  return print_size(*f.size, leaf);
}

// Returns the field's bytes as a reader of their own; whole elements of `l.unit` bytes.
std::string part(const FieldLayout& l, const Leaf& leaf) {
  const Field& f = *l.field;
  const std::string rule_id = quote(f.requirement);
  const std::string bytes =
      ends_with_bytes(f) ? "in.rest()" : "in.part(" + delimited(l, leaf) + ", " + rule_id + ")";
  if (f.repeat != RepeatKind::kToEnd || l.unit == 1) return bytes;
  return bytes + ".multiple(" + std::to_string(l.unit) + ", " + rule_id + ")";
}

std::string case_label(const Switch& choice, std::size_t i) {
  return "case " + key_literal(choice.cases[i].key) + ":\n";
}

// Prints a switch whose cases end in what `then` prints of a type; consecutive keys share it.
template <class Then>
std::string switch_on(const Switch& choice, const std::string& key, Then then) {
  std::string cases;
  for (std::size_t i = 0; i < choice.cases.size(); ++i) {
    cases += case_label(choice, i);
    const Type* const type = choice.cases[i].type;
    if (i + 1 == choice.cases.size() || choice.cases[i + 1].type != type) cases += then(type);
  }
  cases += "default:\n" + then(choice.otherwise ? choice.otherwise->type : nullptr);
  return fill(kSwitch, {{"key", key}, {"cases", cases}});
}

std::string key_of(const Field& f, const Leaf& leaf) {
  const Expr& key = *f.choice->key;
  const std::string text = print(key, leaf);
  const bool is_int =
      key.op == ExprOp::kField && !key.field->is_instance && number_type(*key.field) == "int";
  return is_int ? text : "(int) (" + text + ")";
}

std::string check_field(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  const Leaf leaf = loads_from("bytes");
  const std::string own = member_with("in", f.id);
  const std::string reader = "final WireReader " + own + " = " + part(l, leaf) + ";\n";
  switch (l.shape) {
    case Shape::kNumber:
      if (cpp::has_rule(f)) return take("in", f);
      return "in.skip(" + std::to_string(f.width_bytes) + ", " + quote(f.requirement) + ");\n";
    case Shape::kNested: return "in.nested(" + class_of(*f.type, spec) + "::check);\n";
    case Shape::kNestedRange: return class_of(*f.type, spec) + ".check(" + part(l, leaf) + ");\n";
    case Shape::kChoice:
      return reader + switch_on(*f.choice, key_of(f, leaf), [&](const Type* type) {
               const std::string call =
                   type == nullptr ? "" : "  " + class_of(*type, spec) + ".check(" + own + ");\n";
               return call + "  break;\n";
             });
    case Shape::kStructs: return reader + own + ".each(" + class_of(*f.type, spec) + "::check);\n";
    case Shape::kNumbers:
      if (!cpp::has_rule(f)) break;
      return reader + "while (" + own + ".hasMore()) " + take(own, f);
    case Shape::kBytes: break;
  }
  return part(l, leaf) + ";\n";
}

cpp::SizeText sizes() {
  return [](const FieldLayout& l) {
    const Field& f = *l.field;
    std::string size = std::to_string(f.width_bytes);
    if (l.shape == Shape::kNested) {
      size = f.type->constant_size() ? std::to_string(f.type->max_size)
                                     : member(f.id) + "().sizeBytes()";
    } else if (l.fixed_count) {
      size = std::to_string(l.unit * l.capacity);
    } else if (l.shape != Shape::kNumber && !ends_with_bytes(f)) {
      size = delimited(l, loads_from("bytes"));
    }
    if (!f.condition) return size;
    return "(" + member_with("has", f.id) + "() ? " + size + " : 0)";
  };
}

// Returns the field's bytes within the view.
std::string range_of(const Layout& layout, std::size_t i) {
  const FieldLayout& l = layout.fields[i];
  const std::string at = cpp::offset_of(layout, i, sizes());
  const bool grows =
      l.shape == Shape::kNested ? !l.field->type->constant_size() : ends_with_bytes(*l.field);
  return grows ? "rest(" + at + ")" : "range(" + at + ", " + sizes()(l) + ")";
}

// Returns the number of elements of an array.
std::string count_of(const FieldLayout& l, const std::string& at) {
  const Field& f = *l.field;
  if (l.fixed_count) return std::to_string(l.capacity);
  if (f.repeat == RepeatKind::kCount) return print_size(*f.count, loads_from("bytes"));
  std::string bytes = at == "0" ? "bytes.limit()" : "(bytes.limit() - (" + at + "))";
  if (f.extent == ExtentKind::kSize) bytes = "(" + delimited(l, loads_from("bytes")) + ")";
  return l.unit == 1 ? bytes : bytes + " / " + std::to_string(l.unit);
}

struct Getter {
  std::string type;
  std::string body;
};
Getter getter_of(const Layout& layout, std::size_t i, const Spec& spec) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  const std::string at = cpp::offset_of(layout, i, sizes());
  const std::string base = at == "0" ? "" : at + " + ";
  const std::string unit = std::to_string(l.unit);
  switch (l.shape) {
    case Shape::kNumber:
      return {number_type(f), "return Wire." + wire_name(f) + "(bytes, " + at + ");\n"};
    case Shape::kNested: {
      const std::string name = class_of(*f.type, spec);
      return {name, "return new " + name + "(part(" + range_of(layout, i) + "));\n"};
    }
    case Shape::kNumbers:
      return {number_type(f) + "[]", fill(kNumbers, {{"type", number_type(f)},
                                                     {"count", count_of(l, at)},
                                                     {"wire", wire_name(f)},
                                                     {"at", base},
                                                     {"unit", unit}})};
    case Shape::kStructs: {
      const std::string name = class_of(*f.type, spec);
      return {"List<" + name + ">", fill(kStructs, {{"element", "<" + name + ">"},
                                                    {"count", count_of(l, at)},
                                                    {"class", name},
                                                    {"at", base},
                                                    {"unit", unit}})};
    }
    default: return {"ByteBuffer", "return " + range_of(layout, i) + ";\n"};
  }
}

std::string getter(const Layout& layout, std::size_t i, const Spec& spec) {
  const Field& f = *layout.fields[i].field;
  const Getter one = getter_of(layout, i, spec);
  std::string out;
  std::string absent;
  if (f.condition) {
    const std::string has = member_with("has", f.id);
    out = fill(kGetter, {{"doc", javadoc("Whether " + f.id + " is present.", 2)},
                         {"type", "boolean"},
                         {"name", has},
                         {"absent", ""},
                         {"body", "return " + print(*f.condition, loads_from("bytes")) + ";"}}) +
          "\n";
    absent = "if (!" + has + "()) throw new IllegalStateException(\"no " + f.id + "\");";
  }
  return out +
         fill(kGetter, {{"doc", javadoc(field_text(layout, i), 2)},
                        {"type", one.type},
                        {"name", member(f.id)},
                        {"absent", absent},
                        {"body", one.body}}) +
         "\n";
}

std::string interpretation(const Field& f, const Spec& spec, bool first) {
  const Leaf leaf = loads_from("bytes");
  const auto view_as = [&spec](const Type* type) {
    return "view = orNull(" + class_of(*type, spec) + "::parse, held);\n";
  };
  std::string condition = first ? "" : "view == null";
  const auto also = [&condition](const std::string& text) {
    condition += (condition.empty() ? "" : " && ") + text;
  };
  if (f.condition) {
    const bool is_or = f.condition->op == ExprOp::kOr;
    also(is_or ? "(" + print(*f.condition, leaf) + ")" : print(*f.condition, leaf));
  }
  // The key of bytes that are not there.
  if (f.choice) also("held.hasRemaining()");
  const std::string then =
      !f.choice ? view_as(f.type) : switch_on(*f.choice, key_of(f, leaf), [&](const Type* type) {
        return (type == nullptr ? "" : "  " + view_as(type)) + "  break;\n";
      });
  return condition.empty() ? then : in_if(condition, then);
}

std::string group_getter(const Group& group, const Spec& spec) {
  const Field& over = *group.overlaid;
  const std::string held = member(over.id);
  std::string doc = "What " + over.id + " holds, or null where nothing says it.";
  std::string body;
  if (group.interpretation) {
    doc =
        "What the bytes of " + over.id + " mean: the first interpretation that they fit, or null.";
    std::string tries;
    for (const Field* f : group.fields) tries += interpretation(*f, spec, f == group.fields[0]);
    body = fill(kInterpretations, {{"overlaid", held}, {"tries", tries}});
  } else {
    const auto make = [&](const Type* type) {
      if (type == nullptr) return std::string("  return null;\n");
      return "  return new " + class_of(*type, spec) + "(part(" + held + "()));\n";
    };
    body = over.choice ? switch_on(*over.choice, key_of(over, loads_from("bytes")), make)
                       : make(over.type).substr(2);
  }
  return fill(kGetter, {{"doc", javadoc(doc, 2)},
                        {"type", "WireView"},
                        {"name", member(group.name) + "View"},
                        {"absent", ""},
                        {"body", body}}) +
         "\n";
}

}  // namespace

std::string emit_check(const Layout& layout, const Spec& spec) {
  std::string out;
  for (const FieldLayout& l : layout.fields) {
    const std::string one = check_field(l, spec);
    const auto& condition = l.field->condition;
    out += condition ? in_if(print(*condition, loads_from("bytes")), one) : one;
  }
  if (out.find("(bytes, ") != out.npos) out = "final ByteBuffer bytes = in.bytes();\n" + out;
  if (layout.clamps) out = "in.atMost(MAX_SIZE_BYTES);\n" + out;
  return out;
}

std::string emit_getters(const Layout& layout, const Spec& spec) {
  std::string out;
  std::string visits;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const Field& f = *layout.fields[i].field;
    out += getter(layout, i, spec);
    visits += (f.condition ? "if (" + member_with("has", f.id) + "()) " : "") + "visitor.accept(" +
              quote(f.id) + ", " + member(f.id) + "());\n";
  }
  for (const Group& group : layout.groups) out += group_getter(group, spec);
  const std::string size = layout.has_tail ? "bytes.limit()" : cpp::total_of(layout, sizes());
  return out + fill(kRest, {{"size", size}, {"visits", visits}});
}

}  // namespace rubricc::java
