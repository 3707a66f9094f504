// The user's statements about nodes, and the contradictions that a run shows.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "conformance/check/observation.h"

namespace rubric::check {

/// `--node` and `--sink`. Names no node if neither is given.
class Given {
 public:
  explicit Given(const Options& options) : nodes_(options.nodes) {}

  bool empty() const { return nodes_.empty(); }
  const std::vector<KnownNode>& nodes() const { return nodes_; }
  /// Returns the role of the node with this AM address.
  std::optional<machine::Role> role(std::uint16_t am) const;
  /// Returns the one island that is given for sinks with this address; kNoIsland for none or
  /// several.
  std::uint16_t only_island(std::uint16_t am) const;
  /// Returns the one island that is given for any sink; kNoIsland for none or several.
  std::uint16_t only_island() const;
  /// Returns whether a node of this address is given that may be in that island; kNoIsland
  /// means any.
  bool names(std::uint16_t am, std::uint16_t island) const;
  /// Returns the AM address of sinks, if one is given.
  std::optional<std::uint16_t> sink_am() const;

 private:
  const std::vector<KnownNode>& nodes_;
};

/// The run shows something else about a node than the user says. The run is believed.
struct Contradiction {
  std::uint32_t index = 0;           ///< The observation that shows it.
  ReqId requirement = ReqId::kNone;  ///< The rule that the node breaks if the user is right.
  std::string text;
  std::string expected;
};

/// Describes a node that was given as `role` and does only what nodes of `shown` do.
Contradiction role_contradiction(std::uint16_t am, machine::Role role, machine::Role shown,
                                 std::uint32_t index);

/// Compares given roles with what nodes do in joins.
class GivenRoles {
 public:
  explicit GivenRoles(const Given& given) : given_(given) {}

  /// Learns from a radio frame, observation `index`.
  void look(const machine::Frame& frame, std::uint32_t index);
  /// Returns the given role, unless all that the address does in joins is for the other role; a
  /// base station has no radio. Returns `guess` where nothing is given. Called after all frames.
  machine::Role role_of(std::uint16_t am, machine::Role guess) const;
  void contradict(std::vector<Contradiction>& out) const;

 private:
  struct Joins {
    std::uint32_t as_mote = 0;  ///< Its first observation, + 1.
    std::uint32_t as_sink = 0;
  };
  static bool overruled(const Joins& joins, machine::Role said);

  const Given& given_;
  std::map<std::uint16_t, Joins> joins_;  // By AM address; only given ones.
};

/// A frame that shows a sink's island.
struct Shown {
  std::uint16_t am = 0;
  std::uint16_t island = kNoIsland;
  std::uint32_t index = 0;
};

/// Returns the contradictions between the given islands and those in `shown`, which is in order of
/// the run.
std::vector<Contradiction> island_contradictions(const Run& run, const Given& given,
                                                 const std::vector<Shown>& shown);

}  // namespace rubric::check
