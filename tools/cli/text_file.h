// Files read whole.
#pragma once

#include <string>

namespace rubric::cli {

/// Reads a whole file, or stdin for "-", and unpacks it if it is packed. Returns false, with "path:
/// why" in `error`, if that fails.
bool read_file(const std::string& path, std::string& text, std::string& error);

}  // namespace rubric::cli
