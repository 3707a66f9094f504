// Computes how far the clock of one capture is ahead of another's, from the frames that both have;
// align.h says what this rests on.
#pragma once

#include <cstdint>
#include <string>

#include "conformance/check/align/align.h"
#include "conformance/check/align/align_frames.h"

namespace rubric::check {

/// The result of a comparison.
enum class Clocks : std::uint8_t {
  kAgree,   ///< The frames suggest one clock, or close enough for the rules; `offset_us` is what
            ///< frames that are the same in both say.
  kDiffer,  ///< By offset and drift.
  kUnsure,  ///< The frames do not say; `why` says why.
};

struct ClockFit {
  Clocks clocks = Clocks::kUnsure;
  std::string why;             ///< kUnsure: the second half of a sentence.
  std::int64_t offset_us = 0;  ///< The second file's clock minus the first's, at `at_us`.
  double drift = 0;            ///< Grows by this in a second, in seconds.
  std::int64_t at_us = 0;      ///< On the second file's clock.
  std::size_t frames = 0;      ///< Pairs that agree.
  bool same = false;           ///< Enough of them are the same frame, so that nothing waited.
  double spread_us = 0;        ///< Nine tenths of them are that close to the middle one.

  std::int64_t slack_us = 0;    ///< Stamps of the two files are that good after moved().
  std::int64_t earlier_us = 0;  ///< A log may be earlier by so much, or later by the slack.

  /// Returns a stamp of the second file on the first one's clock.
  std::int64_t moved(std::int64_t time_us) const;
  /// Returns a stamp of the first file on the second one's clock.
  std::int64_t moved_back(std::int64_t time_us) const;
};

/// Fits the clock of the file of `b` to that of the file of `a`. Both have stamps.
ClockFit fit_clock(const Run& run, const CommonFrames& common, const AlignOptions& options);

/// Fits the clock of a log to that of captures: to where fewest effects come before their causes.
/// Its own clock is one of these unless it has its `own_zero`.
ClockFit fit_log(const Run& run, const CommonFrames& common, const AlignOptions& options,
                 bool own_zero);

}  // namespace rubric::check
