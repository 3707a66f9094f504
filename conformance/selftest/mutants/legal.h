// Unusual nodes that keep every rule, in ways that the decisions allow: no golden trace may fail on
// one.
#pragma once

#include <string>
#include <vector>

#include "conformance/selftest/mutants/wrapped.h"
#include "conformance/trace/parameters.h"

namespace rubric::mutants {

struct LegalVariant {
  std::string name;
  std::string reading;  ///< Its behaviour, and the decision that allows it.
  StepMaker step;
  bool weak = false;  ///< A decision calls it weak.
  trace::Statement stated = {};
};

std::vector<LegalVariant> legal_variants();
/// Those that are legal since they state it.
std::vector<LegalVariant> stated_variants();

/// Makes each frame wait for the channel before it leaves by radio, up to `most` ticks.
StepMaker backing_off(std::uint32_t seed, Ticks most);

}  // namespace rubric::mutants
