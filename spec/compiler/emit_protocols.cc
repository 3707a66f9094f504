// protocols.h: the list of all protocols.
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

bool on_serial_line(const Spec& spec) {
  return std::any_of(spec.types.begin(), spec.types.end(),
                     [](const auto& type) { return type->carrier == "serial"; });
}

}  // namespace

GeneratedFiles emit_protocols(const Model& model) {
  std::string inputs, includes, protocols;
  for (const auto& spec : model.specs) {
    if (!spec->named || !on_serial_line(*spec)) continue;
    inputs += (inputs.empty() ? "" : ", ") + spec->file;
    includes += "#include \"codec/generated/" + spec->id + "/tables.h\"\n";
    protocols += "&" + spec->id + "::tables::kProtocol,\n";
  }
  if (protocols.empty()) return {};
  return {{"codec/generated/protocols.h", fill(kHeader, {{"banner", banner("// ", inputs)},
                                                         {"includes", includes},
                                                         {"protocols", protocols}})}};
}

}  // namespace rubricc
