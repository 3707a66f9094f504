// Draws a case's log as a sequence chart.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/report/sequence.h"
#include "conformance/test/suite/cases.h"

namespace rubric::suite {

/// The reference machine's reaction to something that it was given.
struct Reaction {
  std::vector<ReqId> followed;  ///< Rules that it kept without a word.
  std::vector<ReqId> ignored;   ///< Rules by which nothing came of it; kNone: not for this node.
  bool is_ignored = false;
};
/// By node name: one for each line that the node was given, in order.
using Reactions = std::map<std::string, std::vector<Reaction>, std::less<>>;

struct MachineRun {
  CaseRun run;
  Reactions reactions;
};
/// Runs the case on the reference machine.
MachineRun run_on_machine(const SuiteCase& one);

/// The nodes of a case as columns, and the columns between which a line passes.
class Stage {
 public:
  enum class Apps { kAlone, kAll };

  /// Applications have a column where one node alone is under test, or each node's has one.
  explicit Stage(const CaseRun& one, Apps apps = Apps::kAlone);

  const std::vector<std::string>& names() const { return names_; }
  std::size_t column(std::string_view name) const;
  report::SequenceRow row(const trace::Line& line) const;
  /// Returns a few words for each column: "sink 11:1".
  std::vector<std::string> about() const;

 private:
  const std::vector<trace::NodeHeader>& nodes_;
  std::vector<std::string> names_;
  std::map<std::size_t, std::size_t> apps_;  ///< Columns of applications, by those of nodes.
};

/// Returns the message with its key fields: "ack_join 11:5->11:1 seq 1000".
std::string key_text(const trace::Message& message, std::size_t length_max);

/// Charts the whole log: a row for each frame, however many nodes hear it, and for all other
/// events. Leaves out columns without any part in it.
report::Sequence chart(const CaseRun& one, const Reactions& reactions = {});

/// The same with the failures: rows that break a line of the case are marked, and what is missing
/// has a row.
report::Sequence failure_chart(const CaseRun& one);

/// The paper's figure of a join: what passes between the first mote that joins, the sinks that
/// answer it, and their applications. Nothing where the log shows no whole join.
std::optional<report::Sequence> join_chart(const CaseRun& one);

}  // namespace rubric::suite
