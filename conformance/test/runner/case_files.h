// Reads golden traces from a folder.
#pragma once

#include <filesystem>
#include <vector>

#include "conformance/trace/parse.h"

namespace rubric::runner {

/// Returns all .rtr files below `folder`, by name. Throws std::runtime_error if there is none.
std::vector<std::filesystem::path> case_paths(const std::filesystem::path& folder);

/// Reads all .rtr files below `folder`, by name. Throws std::runtime_error with the faults in them,
/// or if there is none.
std::vector<trace::Parsed> load_cases(const std::filesystem::path& folder);

}  // namespace rubric::runner
