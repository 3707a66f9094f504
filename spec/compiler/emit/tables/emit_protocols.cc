// Emits protocols.h: the list of all protocols. route_tables.h: the routes to their messages.
// every_spec.h: the views of all specs.
#include <algorithm>
#include <filesystem>

#include "spec/compiler/emit/cpp_text.h"
#include "spec/compiler/emit/emit.h"

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

/// All specs, also those of the layers below the protocols.
constexpr const Protocol* kSpecs[] = {
    <<specs>>
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

constexpr std::string_view kEverySpec = R"(<<banner>>
#pragma once

<<includes>>

namespace rubric {

/// Calls f(id, messages, for_each_view) for every spec, with its kMessages and its function.
template <class F>
void for_each_spec(F f) {
  <<calls>>
}

}  // namespace rubric
)";

bool on_serial_line(const Spec& spec) {
  return std::any_of(spec.types.begin(), spec.types.end(),
                     [](const auto& type) { return type->carrier == "serial"; });
}

}  // namespace

GeneratedFiles emit_protocols(const Model& model) {
  std::string inputs, includes, protocols, messages, routes;
  std::string folder, all, specs, calls;
  for (const auto& spec : model.specs) {
    if (!spec->named) continue;
    folder = std::filesystem::path(spec->file).parent_path().string();
    includes += "#include \"codec/generated/" + spec->id + "/tables.h\"\n";
    all += "#include \"codec/generated/" + spec->id + "/all.h\"\n";
    specs += "&" + spec->id + "::tables::kProtocol,\n";
    calls += "f(\"" + spec->id + "\", " + spec->id + "::kMessages,\n  [](auto& visitor) { " +
             spec->id + "::for_each_view(visitor); });\n";
    if (!on_serial_line(*spec)) continue;
    inputs += (inputs.empty() ? "" : ", ") + spec->file;
    protocols += "&" + spec->id + "::tables::kProtocol,\n";
    messages += "#include \"codec/generated/" + spec->id + "/messages.h\"\n";
    routes += "{&" + spec->id + "::tables::kProtocol, &" + spec->id + "::messages::kRoutes},\n";
  }
  if (protocols.empty()) return {};
  const std::string from = banner("// ", inputs), from_all = banner("// ", folder);
  return {{"codec/generated/protocols.h", fill(kHeader, {{"banner", from_all},
                                                         {"includes", includes},
                                                         {"protocols", protocols},
                                                         {"specs", specs}})},
          {"codec/generated/every_spec.h",
           fill(kEverySpec, {{"banner", from_all}, {"includes", all}, {"calls", calls}})},
          {"codec/generated/route_tables.h",
           fill(kRoutes, {{"banner", from}, {"includes", messages}, {"routes", routes}})}};
}

}  // namespace rubricc
