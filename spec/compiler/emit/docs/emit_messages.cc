// Emits messages.h: how each message is reached from the start of a frame.
#include <fmt/format.h>

#include <map>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"
#include "spec/compiler/emit/tables/routes.h"

namespace rubricc {
namespace {

constexpr std::string_view kRoutesFile = R"(<<banner>>
#pragma once

<<include>>

namespace rubric {
namespace <<spec>> {
namespace messages {

using reflect::Route;
using reflect::RouteChoice;
using reflect::RouteLength;
using reflect::RouteTable;

<<parts?>>
constexpr RouteTable kRoutes{<<table>>};

}  // namespace messages
}  // namespace <<spec>>
}  // namespace rubric
)";

/// Equal lists are declared once.
class RouteLists {
 public:
  std::string name_of(std::string_view type, std::string_view prefix,
                      const std::vector<RouteNumber>& numbers) {
    if (numbers.empty()) return "nullptr, 0";
    std::vector<std::string> words;
    for (const RouteNumber& one : numbers) {
      words.push_back(fmt::format("{{{}, {}, {}, {}}}", one.offset, one.width_bytes,
                                  one.little_endian, one.value));
    }
    const std::string values = wrap(words, 4);
    const auto [found, fresh] =
        names_.try_emplace(std::string(type) + values, fmt::format("k{}{}", prefix, names_.size()));
    if (fresh) text_ += fmt::format("constexpr {} {}[] = {{\n{}}};\n", type, found->second, values);
    return fmt::format("{}, {}", found->second, numbers.size());
  }
  const std::string& text() const { return text_; }

 private:
  std::map<std::string, std::string> names_;
  std::string text_;
};

std::string type_name(const Spec& spec, const Type& type) {
  return fmt::format("{}::tables::types::{}", type.spec == &spec ? spec.id : type.spec->id,
                     cpp_constant(type.id));
}

}  // namespace

GeneratedFiles emit_messages(const Spec& spec) {
  RouteLists lists;
  std::string routes;
  const std::vector<Route> found = routes_of(spec);
  for (const Route& one : found) {
    // Named here, since the order in which arguments are evaluated is the compiler's.
    const std::string choices = lists.name_of("RouteChoice", "Choices", one.choices);
    const std::string lengths = lists.name_of("RouteLength", "Lengths", one.lengths);
    routes += fmt::format("    {{{}, &{}, {}, {},\n     {}, {}}},\n", cpp_string(one.carrier),
                          type_name(spec, *one.type), one.offset,
                          one.room == UINT32_MAX ? "UINT32_MAX" : std::to_string(one.room), choices,
                          lengths);
  }
  std::string parts = lists.text();
  if (!routes.empty()) parts += "\nconstexpr Route kRouteList[] = {\n" + routes + "};";
  const std::string table =
      found.empty() ? "nullptr, 0" : fmt::format("kRouteList, {}", found.size());
  return {{fmt::format("codec/generated/{}/messages.h", spec.id),
           fill(kRoutesFile, {{"banner", banner("// ", spec.file)},
                              {"spec", spec.id},
                              {"include", cpp_include("codec/generated/" + spec.id + "/tables.h")},
                              {"parts", parts},
                              {"table", table}})}};
}

}  // namespace rubricc
