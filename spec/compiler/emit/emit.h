// The emitters: they turn a checked model into files, and decide nothing.
#pragma once

#include "spec/compiler/generated_file.h"
#include "spec/compiler/model.h"

namespace rubricc {

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
