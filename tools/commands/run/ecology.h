// Islands with their sinks, motes and applications, as a file describes them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "conformance/machine/address.h"

namespace rubric::run {

struct EcologyMote {
  std::uint16_t id = 0;
  machine::Descriptor descriptor;
  std::string app;     ///< A command that speaks JSON lines, "demo", or empty: it only joins.
  std::string target;  ///< Another implementation of it, as for `rubric test`; empty: our own.
};

struct EcologyIsland {
  std::uint16_t island = 0;
  std::string radio;  ///< zep:PORT
  std::string
      serial;       ///< What the sink offers to a program of the user's; empty: its base station.
  std::string app;  ///< Of the base station; empty: none.
  std::string sink_app;  ///< Of the sink, the same.
  std::vector<EcologyMote> motes;
};

struct Ecology {
  std::uint32_t loss_percent = 0;
  std::uint64_t seed = 1;
  std::string space;  ///< An mqtt:// URL; empty: in memory.
  // Given beside the file.
  std::uint32_t gone_after_s = 0;  ///< As of a station.
  bool home_assistant = false;     ///< Whether motes are announced to it, in a space at a broker.
  std::vector<EcologyIsland> islands;
};

/// Reads YAML. Throws std::runtime_error with "name:line: what is wrong".
Ecology parse_ecology(const std::string& text, const std::string& name);

}  // namespace rubric::run
