// all.h: every message of a spec by name, and every field of a value, for tests and tools.
#include "spec/compiler/emit/cpp/emit_cpp_parts.h"
#include "spec/compiler/emit/cpp/emit_cpp_text.h"
#include "spec/compiler/emit/cpp_text.h"

namespace rubricc::cpp {
namespace {

const char kAll[] = R"(/// The fields of a value or of a view in order: visitor(name, field).
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
)";

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
    for (const FieldLayout& l : lay_out(*type).fields) {
      const std::string& id = l.field->id;
      view_calls += (l.field->condition ? "if (view.has_" + id + "()) " : "") +
                    ("visitor(\"" + id + "\", view." + id + "());\n");
      if (l.derived_from) continue;
      calls += "visitor(\"" + id + "\", value." + id + ");\n";
    }
    visits += fill(kVisit, {{"class", name},
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
