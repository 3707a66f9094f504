// The error of lines, and of whoever is at their other end.
#pragma once

#include <stdexcept>

namespace rubric::lines {

/// Thrown when a line or its other end cannot be used: it is gone, hangs, or makes no sense.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rubric::lines
