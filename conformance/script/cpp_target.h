// The independent C++ node of conformance/adapters/cpp in this process, on lines that take as long
// as the machine's: what two implementations do then differs in nothing but themselves.
#pragma once

#include <memory>

#include "conformance/runner/target.h"

namespace rubric::script {

std::unique_ptr<runner::Target> cpp_target();

}  // namespace rubric::script
