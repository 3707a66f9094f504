// Emits the messages in Java: a class for each structure (a view of its bytes and a writer of its
// values), and one each for masks, enums, and the list of a spec's messages. They need the few
// classes of conformance/adapters/java/wire only.
#pragma once

#include "spec/compiler/generated_file.h"
#include "spec/compiler/model.h"

namespace rubricc {

/// Emits conformance/adapters/java/generated/rubric/wire/<spec>/*.java of one checked spec.
GeneratedFiles emit_java(const Spec& spec);

}  // namespace rubricc
