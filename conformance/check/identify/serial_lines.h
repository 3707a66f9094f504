// Serial lines in the first pass: finds the sink of each.
#pragma once

#include <cstdint>
#include <vector>

#include "conformance/check/identify/given.h"
#include "conformance/check/identify/streams.h"

namespace rubric::check {

struct SerialLine {
  std::uint16_t island = kNoIsland;  ///< Now.
  std::uint16_t first = kNoIsland;
  bool given = false;           ///< By the user; no frame has shown it so far.
  bool used = false;            ///< Some net_msg came.
  bool by_host = false;         ///< Only what a host wrote down the line shows its island.
  bool set_later = false;       ///< A SET_ISLAND_ID shows it, and some net_msg came before.
  std::int64_t set_us = 0;      ///< When that came.
  std::uint32_t last_down = 0;  ///< The last packet to the sink that asked for confirmation, + 1.
};

class SerialLines {
 public:
  SerialLines(const Run& run, const Given& given, Streams& streams);

  /// Learns from observation `index`, a serial one.
  void look(std::uint32_t index);
  /// Returns whether it is the host's repetition: the same packet with the next number, while its
  /// confirmation is missing.
  bool repeats(std::uint32_t index);
  const SerialLine& at(std::uint32_t tap) const { return lines_[line_of_[tap]]; }
  /// Returns the islands that lines showed.
  const std::vector<Shown>& shown() const { return shown_; }

 private:
  void join_taps();

  const Run& run_;
  Streams& streams_;
  std::vector<SerialLine> lines_;
  std::vector<std::uint32_t> line_of_;  // By tap.
  std::vector<Shown> shown_;
};

}  // namespace rubric::check
