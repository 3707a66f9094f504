// Unusual nodes that keep every rule, in ways that the decisions leave open: no golden trace may
// fail on one.
#pragma once

#include <string>
#include <vector>

#include "conformance/mutants/wrapped.h"

namespace rubric::mutants {

struct LegalVariant {
  std::string name;
  std::string reading;  ///< What it does, and by which decision it may.
  StepMaker step;
  bool weak = false;  ///< A decision calls it weak.
};

std::vector<LegalVariant> legal_variants();

}  // namespace rubric::mutants
