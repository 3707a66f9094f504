// The error of lines, and of whoever is at their other end.
#pragma once

#include <stdexcept>

namespace rubric::lines {

/// Thrown when a line or its other end cannot be used: it is gone, hangs, or makes no sense.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a forwarder says that serves one program at a time, as a sink does: it closes the
/// connection of another at once.
inline constexpr char kTurnedAway[] =
    "the other end closed it before it began: it may serve another program; 'rubric forward' "
    "shares it";

}  // namespace rubric::lines
