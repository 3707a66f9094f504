// all.h: every message of a spec by name, and every field of a value, for tests and tools.
#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kAll[] =
    R"(/// visit_fields: the fields of a value or of a view in order: visitor(name, field).
/// visit_parts: the messages that a view reads its bytes as: visitor(bytes, view of the message).
<<visits>>
/// Calls visitor(name, ViewTag) for every structure of the spec.
template <class Visitor>
void for_each_view(Visitor& visitor) {
  <<tags>>
}

/// Every structure of the spec by its name in the spec.
constexpr MessageCodec kMessages[] = {
  <<rows>>
};
)";

const char kVisit[] = R"(template <class Visitor>
void visit_fields(<<class>>&<<param?>>, Visitor&<<visitor?>>) {
  <<calls?>>
}
template <class Visitor>
void visit_fields(<<class>>View<<view?>>, Visitor&<<visitor?>>) {
  <<view_calls?>>
}
template <class Visitor>
void visit_parts(<<class>>View<<part_view?>>, Visitor&<<part_visitor?>>) {
  <<parts?>>
}
)";

const char kPart[] = R"(if (view.<<group>>_kind() == <<class>>View::<<Group>>Kind::<<kind>>) {
  visitor(view.<<field>>(), view.<<group>>_as_<<id>>());
}
)";

// Emits the calls for the messages that the bytes of a structure may hold.
std::string parts_of(const Layout& layout) {
  std::string out;
  for (const Group& group : layout.groups) {
    for (const Type* type : group.types) {
      out += fill(kPart, {{"group", group.name},
                          {"Group", pascal(group.name)},
                          {"class", pascal(layout.type->id)},
                          {"kind", cpp_constant(type->id)},
                          {"field", group.overlaid->id},
                          {"id", type->id}});
    }
  }
  return out;
}

}  // namespace

std::string emit_all(const Spec& spec) {
  std::string visits;
  std::string rows;
  std::string tags;
  for (const auto& type : spec.types) {
    if (type->is_mask) continue;
    const std::string name = pascal(type->id);
    std::string calls;
    std::string view_calls;
    const Layout layout = lay_out(*type);
    for (const FieldLayout& l : layout.fields) {
      const std::string& id = l.field->id;
      view_calls += (l.field->condition ? "if (view.has_" + id + "()) " : "") +
                    ("visitor(\"" + id + "\", view." + id + "());\n");
      if (l.derived_from) continue;
      calls += "visitor(\"" + id + "\", value." + id + ");\n";
    }
    const std::string parts = parts_of(layout);
    visits += fill(kVisit, {{"class", name},
                            {"part_view", parts.empty() ? "" : " view"},
                            {"part_visitor", parts.empty() ? "" : " visitor"},
                            {"parts", parts},
                            {"param", calls.empty() ? "" : " value"},
                            {"visitor", calls.empty() ? "" : " visitor"},
                            {"calls", calls},
                            {"view", calls.empty() ? "" : " view"},
                            {"view_calls", view_calls}});
    tags += "visitor(\"" + type->id + "\", ViewTag<" + name + "View>());\n";
    rows += "message_codec<" + name + "View>(\"" + type->id + "\"),\n";
  }
  return fill(kAll, {{"visits", visits}, {"tags", tags}, {"rows", rows}});
}

}  // namespace rubricc::cpp
