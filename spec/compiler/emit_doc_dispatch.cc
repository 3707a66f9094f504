// The page about the wire: the numbers that lead to each message.
#include <set>

#include <fmt/format.h>

#include "spec/compiler/emit_doc.h"
#include "spec/compiler/expr_parser.h"
#include "spec/compiler/html.h"

namespace rubricc {
namespace {

/// Nested lists; the continuation of a type is listed where the type comes first.
class Tree {
 public:
  std::string under(const Type& type) {
    std::string items;
    for (const auto& field : type.fields) items += under(*field);
    for (const auto& instance : type.instances) {
      if (!instance->is_peek) items += under(*instance);
    }
    return items.empty() ? "" : "<ul>\n" + items + "</ul>\n";
  }

 private:
  std::string under(const Field& field) {
    const std::string condition =
        field.condition ? "if " + html_code(to_text(*field.condition)) + ": " : "";
    if (!field.choice) {
      return field.is_instance ? item(condition, *field.type) : "";
    }
    const std::string key = to_text(*field.choice->key);
    std::string cases;
    for (const SwitchCase& one : field.choice->cases) {
      cases += item(html_code(fmt::format("{} == {}", key, to_text(*one.key_expr))) + ": ",
                    *one.type);
    }
    cases += field.choice->otherwise ? item("else: ", *field.choice->otherwise->type)
                                     : "<li>else: opaque bytes</li>\n";
    if (condition.empty()) return cases;
    return "<li>" + condition + "\n<ul>\n" + cases + "</ul></li>\n";
  }

  std::string item(const std::string& before, const Type& type) {
    const bool first = seen_.insert(&type).second;
    const std::string more = first ? under(type) : "";
    return "<li>" + before + link_to(type) + (more.empty() ? "" : "\n" + more) + "</li>\n";
  }

  std::set<const Type*> seen_;
};

}  // namespace

std::string doc_dispatch(const Type& carrier) {
  const std::string tree = Tree().under(carrier);
  return fmt::format("<h4>{}: {}</h4>\n{}", html_escaped(carrier.carrier), link_to(carrier),
                     tree.empty() ? "<p>Leads to nothing else.</p>\n" : tree);
}

}  // namespace rubricc
