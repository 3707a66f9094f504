// Parts of a run, and the smallest that still shows a finding.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/oracle/observation.h"

namespace rubric::report {

/// Frames `first` to `last` of a file, both included; nothing of it where `last` is 0.
struct FrameRange {
  std::uint32_t file = 0;   ///< Index among the run's files.
  std::uint64_t first = 1;
  std::uint64_t last = UINT64_MAX;
};

/// "4..17" in a run of one file, else "2:4..17" with the file's number from 1, "2:none", and "7"
/// for one frame. False, with `error`, for anything else. `file` becomes UINT32_MAX where none is
/// named.
bool parse_range(std::string_view text, FrameRange& out, std::string& error);
std::string range_text(const FrameRange& range, std::size_t files);

/// What is left of a run: of each file the frames of its range, all of those that have none.
/// Without its first frames a run did not start cold, whatever was said before.
oracle::Run part_of(const oracle::Run& run, const std::vector<FrameRange>& ranges,
                    oracle::Options& options);

using Judge = std::function<oracle::Report(const oracle::Run&, const oracle::Options&)>;

/// Looks for small parts of runs that show a finding by themselves. Each one that it returns has
/// been judged and does.
class Windows {
 public:
  Windows(const oracle::Run& run, const oracle::Options& options, Judge judge)
      : run_(run), options_(options), judge_(std::move(judge)) {}

  /// Ranges of all files; none where only the whole run shows it, or the search would take long.
  std::vector<FrameRange> around(const oracle::Finding& finding);

 private:
  /// Observations that all searches together may judge.
  static constexpr std::uint64_t kBudget = 4'000'000;

  std::vector<FrameRange> ranges(std::size_t begin, std::size_t end) const;
  bool shows(std::size_t begin, std::size_t end, const oracle::Finding& finding);

  const oracle::Run& run_;
  const oracle::Options& options_;
  Judge judge_;
  std::uint64_t judged_ = 0;
};

/// Index of what was seen at a place; the number of observations where nothing was.
std::size_t index_of(const oracle::Run& run, const oracle::Place& place);

}  // namespace rubric::report
