// The independent C++ node of conformance/node in this process, on lines with the machine's
// timing, so that two implementations differ only in their own behaviour.
#pragma once

#include <memory>

#include "conformance/test/runner/target.h"

namespace rubric::script {

std::unique_ptr<runner::Target> cpp_target();

}  // namespace rubric::script
