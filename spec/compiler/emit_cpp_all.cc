// all.h: every message of a spec by name, and every field of a value, for tests and tools.
#include "spec/compiler/emit_cpp_parts.h"
#include "spec/compiler/emit_cpp_text.h"
#include "spec/compiler/template.h"

namespace rubricc::cpp {
namespace {

const char kAll[] = R"(<<visits>>
/// Every structure of the spec by its name in the spec.
constexpr MessageCodec kMessages[] = {
  <<rows>>
};
)";

const char kVisit[] = R"(template <class Visitor>
void visit_fields(<<class>>&<<param?>>, Visitor&<<visitor?>>) {
  <<calls?>>
}
)";

}  // namespace

std::string emit_all(const Spec& spec) {
  std::string visits;
  std::string rows;
  for (const auto& type : spec.types) {
    if (type->is_mask) continue;
    const std::string name = pascal(type->id);
    std::string calls;
    for (const FieldLayout& l : lay_out(*type).fields) {
      if (l.derived_from) continue;
      calls += "visitor(\"" + l.field->id + "\", value." + l.field->id + ");\n";
    }
    visits += fill(kVisit, {{"class", name},
                            {"param", calls.empty() ? "" : " value"},
                            {"visitor", calls.empty() ? "" : " visitor"},
                            {"calls", calls}});
    rows += "message_codec<" + name + "View>(\"" + type->id + "\"),\n";
  }
  return fill(kAll, {{"visits", visits}, {"rows", rows}});
}

}  // namespace rubricc::cpp
