// Parts of a run, and the smallest part that still shows a finding.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/check/observation.h"

namespace rubric::report {

/// Frames `first` to `last` of a file, both included; none of it if `last` is 0.
struct FrameRange {
  std::uint32_t file = 0;  ///< Index among the run's files.
  std::uint64_t first = 1;
  std::uint64_t last = UINT64_MAX;
};

/// Parses "4..17" in a run of one file, else "2:4..17" with the file's number from 1, "2:none", and
/// "7" for one frame. Returns false, with `error`, for anything else. `file` becomes UINT32_MAX if
/// none is named.
bool parse_range(std::string_view text, FrameRange& out, std::string& error);
std::string range_text(const FrameRange& range, std::size_t files);

/// Returns the part of a run within the ranges: frames of a file with a range, and files without
/// one whole. Without its first frames a run does not start cold, whatever was stated.
check::Run part_of(const check::Run& run, const std::vector<FrameRange>& ranges,
                   check::Options& options);

using Judge = std::function<check::Report(const check::Run&, const check::Options&)>;

/// Searches for small parts of runs that show a finding by themselves. Each one that it returns has
/// been judged and does.
class Windows {
 public:
  Windows(const check::Run& run, const check::Options& options, Judge judge)
      : run_(run), options_(options), judge_(std::move(judge)) {}

  /// Returns the ranges of all files; none if only the whole run shows it, or the search would take
  /// long.
  std::vector<FrameRange> around(const check::Finding& finding);

 private:
  /// Observations that all searches together may judge: some for each of the run, however many
  /// findings there are, and enough for a short run.
  std::uint64_t budget() const {
    return std::min<std::uint64_t>(4'000'000, 100'000 + 200 * run_.seen.size());
  }

  std::vector<FrameRange> ranges(std::size_t begin, std::size_t end) const;
  bool shows(std::size_t begin, std::size_t end, const check::Finding& finding);

  const check::Run& run_;
  const check::Options& options_;
  Judge judge_;
  std::uint64_t judged_ = 0;
};

/// Returns the index of the observation at a place; the number of observations if there is none.
std::size_t index_of(const check::Run& run, const check::Place& place);

}  // namespace rubric::report
