// Exports the machine with its mutants. Compiled together with the copies of its sources.
#include "conformance/selftest/source_mutants/machine.h"

extern "C" {
int rubric_source_mutant = 0;

__attribute__((visibility("default"))) const rubric::source_mutants::MachineFunctions*
rubric_mutated_machine() {
  static constexpr rubric::source_mutants::MachineFunctions kFunctions{
      [](int mutant) { rubric_source_mutant = mutant; }, rubric::machine::start,
      rubric::machine::step, rubric::machine::timers};
  return &kFunctions;
}
}
