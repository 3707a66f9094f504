// Describes in words who sent what to whom: the frames of a run as a report shows them.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "conformance/check/identify/identity.h"
#include "conformance/check/observation.h"

namespace rubric::report {

/// A run with the results of the first pass. Borrows the run.
class Scene {
 public:
  Scene(const check::Run& run, const check::Options& options);

  const check::Run& run() const { return run_; }
  std::size_t nodes() const { return who_.devices.size(); }
  /// Returns "mote 2", "sink 11" (its island), "sink #1" (its address), "base 11", "unknown 7".
  const std::string& name(std::uint16_t node) const { return names_[node]; }
  /// Returns the node that a finding names; kNobody for others.
  std::uint16_t node_named(const std::string& name) const;
  /// Returns the rank of its column: base station and sink, motes, further sinks.
  std::size_t column_rank(std::uint16_t node) const { return ranks_[node]; }

  /// Returns the sender of observation `i`; kNobody if unknown.
  std::uint16_t sender(std::size_t i) const { return who_.marks[i].device; }
  /// Returns its receivers, all of them if that may be several.
  std::vector<std::uint16_t> receivers(std::size_t i) const;
  bool concerns(std::size_t i, std::uint16_t node) const;
  /// Returns the numbers of the motes that it concerns: ends of the frame or of the message within.
  std::vector<std::uint16_t> topic(std::size_t i) const;
  /// Returns whether it is the link's own repetition, a log's second line of the same, or an
  /// acknowledgement of the link.
  bool is_echo(std::size_t i) const;

  /// Returns the text of an arrow: "join_request 7", "ack of 4660".
  std::string label(std::size_t i) const;
  /// Returns the whole message: "join_request(seq_num=7 ...)".
  std::string message(std::size_t i) const;
  /// Returns "mote 2 > sink 11".
  std::string route(std::size_t i) const;

 private:
  void add_radio_receivers(std::size_t i, std::vector<std::uint16_t>& out) const;

  const check::Run& run_;
  check::Identity who_;
  std::vector<std::string> names_;
  std::vector<std::size_t> ranks_;
  std::set<std::uint16_t> sinks_;                              // Their AM addresses.
  std::map<std::uint16_t, std::vector<std::uint16_t>> of_am_;  // Devices; of 0xFFFF all.
};

}  // namespace rubric::report
