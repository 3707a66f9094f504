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
  bool given = false;              ///< By the user; no frame has shown it so far.
  bool used = false;               ///< Some net_msg came.
  bool by_host = false;            ///< Only what a host wrote down the line shows its island.
  bool told = false;               ///< A SET_ISLAND_ID was seen.
  std::uint16_t back = kNoIsland;  ///< Of which its sink says that it is since it was told another.
  bool first_told = false;         ///< `first` is what it was told, and nothing came since.
  bool set_later = false;          ///< A SET_ISLAND_ID shows it, and some net_msg came before.
  std::int64_t set_us = 0;         ///< When that came.
  std::uint32_t last_down = 0;  ///< The last packet to the sink that asked for confirmation, + 1.
  std::vector<std::uint16_t> its;  ///< Islands of which the sink says that it is, or motes joined.
};

class SerialLines {
 public:
  SerialLines(const Run& run, const Options& options, const Given& given, Streams& streams);

  /// Learns from observation `index`, a serial one.
  void look(std::uint32_t index);
  /// Returns whether it is the host's repetition: the same packet with the next number, while its
  /// confirmation is missing.
  bool repeats(std::uint32_t index);
  const SerialLine& at(std::uint32_t tap) const { return lines_[line_of_[tap]]; }
  /// Returns whether the sink that was of island `before`, and no line's other, says on its line
  /// that it is of island `now`: one heard there is perhaps the same.
  /// `told`: a host may have told it the former one before the capture.
  bool alone_reports(std::uint16_t before, std::uint16_t now, bool told) const;
  /// Returns the islands that lines showed.
  const std::vector<Shown>& shown() const { return shown_; }

 private:
  void join_taps();

  const Run& run_;
  Streams& streams_;
  const std::int64_t under_way_us_;  // How late a report of before SET_ISLAND_ID comes.
  std::vector<SerialLine> lines_;
  std::vector<std::uint32_t> line_of_;  // By tap.
  std::vector<Shown> shown_;
};

}  // namespace rubric::check
