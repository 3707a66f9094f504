// Files of the project that targets contain.
#pragma once

#include <map>
#include <string>

namespace rubric::fuzz {

/// Returns texts by paths in the project, "spec/requirements.yaml": of the files that
/// fuzz/CMakeLists.txt names. Generated when the program is built.
const std::map<std::string, std::string>& embedded_files();

}  // namespace rubric::fuzz
