// The machine with all its mutants, in a shared library: the rest of the program uses the
// machine's own headers, so that its functions must stay apart.
#pragma once

#include "conformance/machine/step.h"

namespace rubric::source_mutants {

using machine::DueTimers;

struct MachineFunctions {
  void (*choose)(int mutant);
  machine::State (*start)(const machine::Config&);
  void (*step)(machine::State&, machine::Ticks, const machine::Event&, machine::Actions&);
  DueTimers (*timers)(const machine::State&);
};

/// Returned by the library's one exported function, "rubric_mutated_machine".
using GetMachine = const MachineFunctions* (*)();

}  // namespace rubric::source_mutants
