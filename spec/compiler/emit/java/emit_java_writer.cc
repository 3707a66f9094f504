// Emits the writing half of a class: values, and the steps that store them.
#include "spec/compiler/check/intervals.h"
#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/java/emit_java_text.h"

namespace rubricc::java {
namespace {

const char kWriter[] = R"(@Override
public Writer toWriter() {
  final Writer out = new Writer();
  <<copies>>
  return out;
}

<<doc>>
public static final class Writer extends WireWriter {
  <<members>>

  public Writer() {
    super(<<class>>::check, <<rule>>);
  }

  <<setters>>

  @Override
  public void store(WireOutput out) throws WireException {
    <<steps>>
  }
}
)";

const char kSetter[] = R"(<<doc>>
public Writer <<name>>(<<type>> value) {
  <<whole?>>
  <<own>> = <<value>>;
  return this;
}
)";

// Returns the member, in methods that have locals of their own.
std::string own(const Field& f) {
  const std::string name = member(f.id);
  const bool hidden = name == "value" || name == "out" || name == "start";
  return (hidden ? "this." : "") + name;
}

bool is_bytes(const FieldLayout& l) {
  return l.shape == Shape::kBytes || l.shape == Shape::kChoice || l.shape == Shape::kNestedRange;
}

// Returns the number of elements, or bytes, that must always be there; 0 if it is free.
std::int64_t fixed_size(const FieldLayout& l) {
  const Field& f = *l.field;
  if (l.fixed_count) return l.capacity;
  const bool constant = is_bytes(l) && f.extent == ExtentKind::kSize && f.size->op == ExprOp::kInt;
  return constant ? f.size->value : 0;
}

struct Member {
  std::string type;
  std::string initial;
  std::string setter_value;
};
Member member_of(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  const std::string size = std::to_string(fixed_size(l));
  const bool fixed = fixed_size(l) != 0;
  if (is_bytes(l)) return {"byte[]", fixed ? "new byte[" + size + "]" : "{}", "value.clone()"};
  if (f.kind == ValueKind::kStruct) {
    const std::string writer = class_of(*f.type, spec) + ".Writer";
    if (l.shape == Shape::kStructs) {
      return {"List<" + writer + ">", "List.of()", "List.copyOf(value)"};
    }
    return {writer, "new " + writer + "()", "value"};
  }
  const std::string number = number_type(f);
  const Interval range = width_range(f.width_bytes, f.kind == ValueKind::kSint);
  const std::string within =
      "Wire.fit(value, " + literal(range.min) + ", " + literal(range.max) + ")";
  if (l.shape == Shape::kNumbers) {
    const std::string initial = fixed ? "new " + number + "[" + size + "]" : "{}";
    return {number + "[]", initial, number == "float" ? "value.clone()" : within};
  }
  return {number, "", number == "float" ? "value" : within};
}

std::string setter(const Layout& layout, std::size_t i, const Member& one) {
  const FieldLayout& l = layout.fields[i];
  const Field& f = *l.field;
  std::string whole;
  if (fixed_size(l) != 0) {
    const std::string count = l.shape == Shape::kStructs ? "value.size()" : "value.length";
    whole = "Wire.whole(" + count + ", " + std::to_string(fixed_size(l)) + ");";
  }
  std::string out = fill(kSetter, {{"doc", javadoc(field_text(layout, i), 4)},
                                   {"name", member(f.id)},
                                   {"own", own(f)},
                                   {"type", one.type},
                                   {"whole", whole},
                                   {"value", one.setter_value}});
  if (!is_bytes(l)) return out;
  return out + "\n" +
         fill(kSetter, {{"doc", "/** The same; copies what is left in the buffer. */"},
                        {"name", member(f.id)},
                        {"own", own(f)},
                        {"type", "ByteBuffer"},
                        {"whole", ""},
                        {"value", "Wire.copy(value)"}});
}

// Returns the number of a length that is not kept itself.
std::string length_of(const Layout& layout, const Field& holder) {
  for (const FieldLayout& l : layout.fields) {
    if (l.field != &holder) continue;
    const std::string count = own(holder) + (l.shape == Shape::kStructs ? ".size()" : ".length");
    const bool elements = holder.repeat == RepeatKind::kCount || l.unit == 1;
    return elements ? count : count + " * " + std::to_string(l.unit);
  }
  return "";
}

std::string step(const Layout& layout, const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  const std::string name = own(f);
  const std::string put = "out." + wire_name(f) + "(";
  if (l.derived_from) {
    return put + "out.length(" + length_of(layout, *l.derived_from) + ", " + literal(f.range.min) +
           ", " + literal(f.range.max) + ", " + quote(f.requirement) + "));\n";
  }
  switch (l.shape) {
    case Shape::kNumber: return put + name + ");\n";
    case Shape::kNested: return name + ".store(out);\n";
    case Shape::kNumbers:
      return "for (final " + number_type(f) + " value : " + name + ") " + put + "value);\n";
    case Shape::kStructs:
      return "for (final " + class_of(*f.type, spec) + ".Writer value : " + name +
             ") value.store(out);\n";
    default: return "out.bytes(" + name + ");\n";
  }
}

std::string copy(const FieldLayout& l, const Spec& spec) {
  const Field& f = *l.field;
  const std::string name = member(f.id);
  std::string value = name + "()";
  if (l.shape == Shape::kNested) value += ".toWriter()";
  if (l.shape == Shape::kStructs) {
    value += ".stream().map(" + class_of(*f.type, spec) + "::toWriter).toList()";
  }
  return (f.condition ? "if (" + member_with("has", f.id) + "()) " : "") + "out." + name + "(" +
         value + ");\n";
}

}  // namespace

std::string emit_writer(const Layout& layout, const Spec& spec) {
  std::string members;
  std::string setters;
  std::string steps;
  std::string copies;
  std::string lengths;
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const FieldLayout& l = layout.fields[i];
    const Field& f = *l.field;
    const std::string one = step(layout, l, spec);
    const Leaf leaf = loads_from("out.bytes()", "start");
    steps += f.condition ? in_if(print(*f.condition, leaf), one) : one;
    if (l.derived_from) {
      lengths += " " + f.id + " is the size of " + l.derived_from->id + ".";
      continue;
    }
    const Member kept = member_of(l, spec);
    members += "private " + kept.type + " " + member(f.id) +
               (kept.initial.empty() ? "" : " = " + kept.initial) + ";\n";
    setters += (setters.empty() ? "" : "\n") + setter(layout, i, kept);
    copies += copy(l, spec);
  }
  if (steps.find("start") != steps.npos) steps = "final int start = out.size();\n" + steps;
  const std::string doc = "Values of " + layout.type->name + ", to be written." + lengths;
  return fill(kWriter, {{"copies", copies},
                        {"doc", javadoc(doc, 2)},
                        {"members", members},
                        {"class", class_name(layout.type->id)},
                        {"rule", quote(layout.type->requirement)},
                        {"setters", setters},
                        {"steps", steps}});
}

}  // namespace rubricc::java
