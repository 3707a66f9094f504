// A run that is followed for as long as one likes, in memory that its horizon bounds.
//
// What the rules need of the past is of two kinds. Causes and effects lie close together: an answer
// is due within the response time, a repetition within a period, an ack within its timeout. And
// there is what nodes are: addresses and islands, who joined whom, which numbers were the last. So
// frames are held for a horizon, several times the longest of the stated times, and of older ones
// only those that show what nodes are: for each mote the frames of its last joins, for each sender
// and line the last ones, and what set an island. They begin the run that is judged (Run::past).
//
// Judged is what is held, again and again. A finding is settled once it is older than the horizon:
// it stays as it is from then on, and the report at the end has it. Frames go when they are
// older than two horizons, so that each frame is judged with a horizon before it and one after it.
//
// Where a missing cause may lie among frames that are gone, no node is blamed, as if the sniffer
// had missed them (Identity::damaged()). So a run that is followed fails where `rubric check` of
// the whole does; what needs a cause or an effect beyond the horizon becomes inconclusive, or is
// not found.
//
// Nothing is let go of runs in which times do not order frames: where a file has no stamps, or lies
// on a clock that could not be compared, and while a step of a clock is within the horizon.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/check/input/read.h"
#include "conformance/check/observation.h"

namespace rubric::check {

/// Returns the horizon that follows from the stated times, at least a minute. No node of a run that
/// is followed has others, as no log is.
std::int64_t horizon_us(const Options& options);

class Follow {
 public:
  /// Both references are kept. Judges with a horizon of `horizon_us`.
  Follow(const AlignOptions& align, const Options& options, std::int64_t horizon_us);

  /// As those of RunReader. take() judges by itself where otherwise too much would gather.
  std::uint32_t open(const std::string& name) { return reader_.open(name); }
  void take(std::uint32_t file, const Packet& packet, std::string_view interface_name,
            std::uint64_t number = 0);

  /// Judges what is held. Returns false, with why(), if the files are no run.
  bool judge();
  const std::string& why() const { return why_; }
  /// Returns the run as it was judged last, without the frames that are gone.
  const Run& run() const { return run_; }
  /// Returns the findings of the whole run so far.
  const Report& report() const { return report_; }
  std::size_t held() const { return reader_.held() + past_.size(); }

 private:
  bool may_settle(std::int64_t until_us) const;
  void settle(std::int64_t until_us);
  void add_report(Report now, std::int64_t settles_us);
  void let_go();

  const Options& options_;
  Options options_later_;  // Once frames are gone: the run did not begin with the first one held.
  std::int64_t horizon_us_;
  RunReader reader_;
  Past gone_;
  std::vector<Observation> past_;  // Of older frames: those that are kept.
  std::shared_ptr<RunStorage> past_bytes_;
  std::shared_ptr<RunStorage> run_bytes_;  // Those of past_ as run_ has them.
  Run run_;
  Report report_;
  std::string why_;
  std::int64_t settled_us_ = 0;  // Findings before this are settled.
  std::vector<Finding> settled_;
  std::uint64_t more_ = 0;                          // Settled findings that are not listed.
  std::map<std::size_t, std::uint64_t> exercised_;  // By place in the catalogue.
  std::size_t judge_at_ = 0;                        // take() judges when so many are held.
};

}  // namespace rubric::check
