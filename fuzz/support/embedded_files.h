// Files of the project that targets carry with them.
#pragma once

#include <string_view>

namespace rubric::fuzz {

/// The text of a file by its name in the project ("spec/requirements.yaml"); null for those that
/// fuzz/CMakeLists.txt does not name. Generated when the program is built.
const char* embedded_file(std::string_view name);

}  // namespace rubric::fuzz
