// Unusual nodes that keep every rule, in ways that the decisions allow: no golden trace may fail on
// one.
#pragma once

#include <string>
#include <vector>

#include "conformance/selftest/mutants/wrapped.h"

namespace rubric::mutants {

struct LegalVariant {
  std::string name;
  std::string reading;  ///< Its behaviour, and the decision that allows it.
  StepMaker step;
  bool weak = false;  ///< A decision calls it weak.
};

std::vector<LegalVariant> legal_variants();

}  // namespace rubric::mutants
