// The machine's units of time: the simulator counts microseconds since the start of the run, its
// nodes ticks.
#pragma once

#include "conformance/machine/ticks.h"

namespace rubric::simulate {

using machine::kUsPerSecond;
using machine::Micros;
using machine::ticks_of;
using machine::us_of;

}  // namespace rubric::simulate
