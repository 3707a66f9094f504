// Time as lines count it.
#pragma once

#include <chrono>

namespace rubric::lines {

using SteadyTime = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

}  // namespace rubric::lines
