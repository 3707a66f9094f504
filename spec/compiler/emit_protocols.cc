// Emits protocols.h: the list of all protocols. route_tables.h: the routes to their messages.
#include <algorithm>

#include "spec/compiler/cpp_text.h"
#include "spec/compiler/emit.h"
#include "spec/compiler/template.h"

namespace rubricc {
namespace {

constexpr std::string_view kHeader = R"(<<banner>>
#pragma once

<<includes>>

namespace rubric {
namespace reflect {

/// The protocols that travel on active messages: those with a structure for the serial line.
constexpr const Protocol* kProtocols[] = {
    <<protocols>>
};

}  // namespace reflect
}  // namespace rubric
)";

constexpr std::string_view kRoutes = R"(<<banner>>
#pragma once

<<includes>>

namespace rubric {
namespace reflect {

/// A protocol and the ways to its messages.
struct ProtocolRoutes {
  const Protocol* protocol;
  const RouteTable* routes;
};

/// Of each of kProtocols.
constexpr ProtocolRoutes kProtocolRoutes[] = {
    <<routes>>
};

}  // namespace reflect
}  // namespace rubric
)";

bool on_serial_line(const Spec& spec) {
  return std::any_of(spec.types.begin(), spec.types.end(),
                     [](const auto& type) { return type->carrier == "serial"; });
}

}  // namespace

GeneratedFiles emit_protocols(const Model& model) {
  std::string inputs, includes, protocols, messages, routes;
  for (const auto& spec : model.specs) {
    if (!spec->named || !on_serial_line(*spec)) continue;
    inputs += (inputs.empty() ? "" : ", ") + spec->file;
    includes += "#include \"codec/generated/" + spec->id + "/tables.h\"\n";
    protocols += "&" + spec->id + "::tables::kProtocol,\n";
    messages += "#include \"codec/generated/" + spec->id + "/messages.h\"\n";
    routes += "{&" + spec->id + "::tables::kProtocol, &" + spec->id + "::messages::kRoutes},\n";
  }
  if (protocols.empty()) return {};
  const std::string from = banner("// ", inputs);
  return {
      {"codec/generated/protocols.h",
       fill(kHeader, {{"banner", from}, {"includes", includes}, {"protocols", protocols}})},
      {"codec/generated/route_tables.h",
       fill(kRoutes, {{"banner", from}, {"includes", messages}, {"routes", routes}})}};
}

}  // namespace rubricc
