// Emits the codec in C++14: a header for each structure and mask, one for the enums, and one with
// everything, for tests and tools. The headers depend on codec/runtime only.
#pragma once

#include "spec/compiler/generated_file.h"
#include "spec/compiler/model.h"

namespace rubricc {

/// Returns the codec of one checked spec: codec/generated/<spec>/*.h.
std::vector<GeneratedFile> emit_cpp(const Spec& spec);

}  // namespace rubricc
