// Distributions in bounded memory, whatever is counted.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace rubric::stats {

/// The time between neighbouring frames. Gaps whose highest 6 bits are the same are counted
/// together, so that a percentile is one of the gaps, and 3.2 % too long at most.
class Gaps {
 public:
  /// Takes a gap of 0 or more nanoseconds.
  void take(std::int64_t gap_ns);
  std::uint64_t count() const { return count_; }
  /// Returns the gap that `percent` of all do not exceed; -1 if there is none.
  std::int64_t percentile(double percent) const;

 private:
  struct Bucket {
    std::uint64_t count = 0;
    std::int64_t most_ns = 0;  // The longest of them.
  };
  std::vector<Bucket> buckets_;
  std::uint64_t count_ = 0;
};

/// Frames over time, in at most kBinsMost bins of equal width, which grows from a millisecond on.
class TimeLine {
 public:
  static constexpr std::int64_t kBinsMost = 60;

  void take(std::int64_t time_ns);
  std::int64_t width_ns() const { return width_ns_; }
  /// Returns the frames by bin, which begins at its number times width_ns(). Empty bins are absent.
  const std::map<std::int64_t, std::uint64_t>& bins() const { return bins_; }

 private:
  std::int64_t bin_of(std::int64_t time_ns) const;
  void widen();

  std::map<std::int64_t, std::uint64_t> bins_;
  std::int64_t width_ns_ = 1'000'000;
  bool times_five_ = true;  // What the width grows by next: 1, 5, 10, 50 ms and so on.
};

}  // namespace rubric::stats
