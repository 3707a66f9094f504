// Files of the project that targets contain.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "fuzz/support/require.h"
#include "spec/compiler/load/load.h"

namespace rubric::fuzz {

/// Returns texts by paths in the project, "spec/requirements.yaml": of the files that
/// fuzz/CMakeLists.txt names. Generated when the program is built.
const std::map<std::string, std::string>& embedded_files();

/// Returns the project's rules.
inline const std::vector<rubricc::Requirement>& rules() {
  static const std::vector<rubricc::Requirement> all = [] {
    const std::string file = "spec/requirements.yaml";
    rubricc::Model model;
    rubricc::Diagnostics diagnostics;
    rubricc::load_requirements_text(file, embedded_files().at(file), model, diagnostics);
    require(diagnostics.empty(), "the project's own rules are good");
    return model.requirements;
  }();
  return all;
}

}  // namespace rubric::fuzz
