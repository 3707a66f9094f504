// The emitters: they turn a checked model into files, and decide nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spec/compiler/model.h"

namespace rubricc {

/// The result of an emitter; main.cc writes it.
struct GeneratedFile {
  std::string path;  // From the project's folder, with '/': "codec/generated/rubicon/tables.h".
  std::string text;
};
using GeneratedFiles = std::vector<GeneratedFile>;

/// Emits codec/generated/<spec>/*.h, the codec of one checked spec in C++14: a header for each
/// structure and mask, one for the enums, and one with everything, for tests and tools. The headers
/// depend on codec/runtime only.
GeneratedFiles emit_cpp(const Spec& spec);
/// Emits conformance/adapters/java/generated/rubric/wire/<spec>/*.java of one checked spec: a class
/// for each structure (a view of its bytes and a writer of its values), and one each for masks,
/// enums, and the list of a spec's messages. They need conformance/adapters/java/wire only.
GeneratedFiles emit_java(const Spec& spec);
/// Returns whether frames begin with the type, and hold messages that dissectors show.
bool leads_to_messages(const Type& type);
/// Emits tools/wireshark/generated/rubric.lua: one file for all named specs that have such types,
/// and their imports; nothing if there is none. Frames are read by the protocol `usual`
/// until the user chooses, else by the one with the most types. For Lua 5.2 and later.
GeneratedFiles emit_lua(const Model& model, std::string_view usual = {});
/// Emits codec/generated/<spec>/tables.h: reflection tables, see codec/reflect/schema.h.
GeneratedFiles emit_tables(const Spec& spec);
/// Emits codec/generated/requirements_table.h.
GeneratedFiles emit_requirements(const Model& model, const std::string& file);
/// Emits codec/generated/protocols.h, the list of all protocols, route_tables.h, the routes to
/// their messages (of the emitter `messages`), and every_spec.h, the views of all specs for tests;
/// nothing if there is no protocol.
GeneratedFiles emit_protocols(const Model& model);
/// Emits fuzz/dictionaries/<spec>.dict for libFuzzer.
GeneratedFiles emit_dictionary(const Spec& spec);
/// Emits codec/generated/<spec>/messages.h: the routes to messages, for the structure-aware fuzzer.
GeneratedFiles emit_messages(const Spec& spec);
/// Emits conformance/generated/profiles.h; nothing if there is no profile.
GeneratedFiles emit_profiles(const Model& model);
/// Emits conformance/generated/cases.h; `folder` is where the cases are from.
GeneratedFiles emit_cases(const Model& model, const std::string& folder);
/// Emits doc/wire.json: the model for programs that print it.
GeneratedFiles emit_json(const Model& model);

}  // namespace rubricc
