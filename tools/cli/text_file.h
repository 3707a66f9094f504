// Files read whole.
#pragma once

#include <string>

namespace rubric::cli {

/// The whole of a file, or of stdin for "-". False, with "path: why" in `error`, if that cannot be
/// read.
bool read_file(const std::string& path, std::string& text, std::string& error);

}  // namespace rubric::cli
