// The parameters that an implementation states of itself (its IXIT): one list for traces, rct/1,
// `rubric test --state` and `rubric check --state`. It is the protocol's.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rubric::trace {

/// RUBICON's. Another protocol's have the numbers of their places in its list.
enum class ParameterId : std::uint8_t {
  kResponse,
  kJoinPeriod,
  kJoinRequests,
  kAckJoins,
  kAckTimeout,
  kChannelAccess,
  kMembers,
  kChannels,
  kSynapticPeriod,
  kSynapticPhase,
  kGoneAfter,
  kBuffers,
};

struct Parameter {
  ParameterId id = ParameterId::kResponse;
  std::string name;  ///< `ack_timeout`
  std::string unit;  ///< "ticks", or what is counted.
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::int64_t unstated = 0;  ///< Of nodes that state none, where no profile says it.
  int decision = 0;           ///< The decision that lets an implementation state it; 0: none.
  std::string doc;            ///< A sentence.
};

/// In the order of their ids.
std::span<const Parameter> parameters();
const Parameter& parameter(ParameterId id);
/// Returns the parameter of this name, or null.
const Parameter* find_parameter(std::string_view name);
/// Returns the names of all, for errors: "response, join_period, ...".
std::string parameter_names();

/// `ack_timeout=2000`
struct Stated {
  ParameterId id = ParameterId::kResponse;
  std::int64_t value = 0;
  friend bool operator==(const Stated&, const Stated&) = default;
};
/// Each parameter at most once.
using Statement = std::vector<Stated>;

/// Returns the value that is stated, or null.
const std::int64_t* find(const Statement& statement, ParameterId id);
/// Adds what `word` states, such as `ack_timeout=2000`; returns what is wrong with it, or nothing.
std::string add_stated(std::string_view word, Statement& out);
/// Returns `first`, and what only `second` states.
Statement joined(Statement first, const Statement& second);
/// Returns "ack_timeout=2000 response=350".
std::string statement_text(const Statement& statement);

/// `join_requests=2..255`, or `members=20`, which is both ends.
struct StatedRange {
  ParameterId id = ParameterId::kResponse;
  std::int64_t least = 0;
  std::int64_t most = 0;
  friend bool operator==(const StatedRange&, const StatedRange&) = default;
};
/// Adds the range that `word` says; returns what is wrong with it, or nothing.
std::string add_range(std::string_view word, std::vector<StatedRange>& out);
/// Returns "join_requests=2..255".
std::string range_text(const StatedRange& range);

}  // namespace rubric::trace
