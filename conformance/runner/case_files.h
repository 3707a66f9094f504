// Golden traces from a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "conformance/trace/parse.h"

namespace rubric::runner {

/// All .rtr files below `folder`, by name. Throws std::runtime_error with what is wrong in them, or
/// when there is none.
std::vector<trace::Parsed> load_cases(const std::filesystem::path& folder);

}  // namespace rubric::runner
