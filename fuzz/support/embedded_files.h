// Files of the project that targets contain.
#pragma once

#include <string_view>

namespace rubric::fuzz {

/// Returns the text of a file by its path in the project ("spec/requirements.yaml"); null for those
/// that fuzz/CMakeLists.txt does not name. Generated when the program is built.
const char* embedded_file(std::string_view name);

}  // namespace rubric::fuzz
