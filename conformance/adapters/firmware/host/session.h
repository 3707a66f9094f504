// rct/1 (conformance/PORTING.md) on standard input and output, over one board or several kinds.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "conformance/adapters/firmware/host/bridge.h"

namespace rubric::firmware {

/// A board with its firmware, and its possible roles.
struct Station {
  std::unique_ptr<SimulatedBoard> board;
  std::unique_ptr<Bridge> bridge;
  Firmware firmware;
};

/// Answers commands until `bye` or the end of the input; returns the exit status. `time` is
/// `virtual` or `real`.
int serve(std::vector<Station>& stations, const std::string& name, const std::string& time);

}  // namespace rubric::firmware
