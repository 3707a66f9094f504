#include "tools/commands/stats/distribution.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rubric::stats {
namespace {

constexpr int kKeptBits = 6;
constexpr std::uint64_t kExact = std::uint64_t{1} << kKeptBits;  // Smaller values are exact.
constexpr std::int64_t kWidthMost = INT64_MAX / 8;

std::size_t bucket_of(std::uint64_t value) {
  if (value < kExact) return value;
  const int shift = static_cast<int>(std::bit_width(value)) - kKeptBits;
  return static_cast<std::size_t>(shift) * (kExact / 2) + (value >> shift);
}

}  // namespace

void Gaps::take(std::int64_t gap_ns) {
  gap_ns = std::max<std::int64_t>(gap_ns, 0);
  const std::size_t at = bucket_of(static_cast<std::uint64_t>(gap_ns));
  if (at >= buckets_.size()) buckets_.resize(at + 1);
  Bucket& bucket = buckets_[at];
  ++bucket.count;
  bucket.most_ns = std::max(bucket.most_ns, gap_ns);
  ++count_;
}

std::int64_t Gaps::percentile(double percent) const {
  if (count_ == 0) return -1;
  const double share = std::ceil(percent / 100 * static_cast<double>(count_));
  const auto wanted = std::max<std::uint64_t>(static_cast<std::uint64_t>(share), 1);
  std::uint64_t seen = 0;
  for (const Bucket& bucket : buckets_) {
    seen += bucket.count;
    if (seen >= wanted) return bucket.most_ns;
  }
  return -1;
}

std::int64_t TimeLine::bin_of(std::int64_t time_ns) const {
  const std::int64_t bin = time_ns / width_ns_;
  return time_ns % width_ns_ < 0 ? bin - 1 : bin;
}

void TimeLine::take(std::int64_t time_ns) {
  ++bins_[bin_of(time_ns)];
  while (width_ns_ < kWidthMost && bins_.rbegin()->first - bins_.begin()->first >= kBinsMost) {
    widen();
  }
}

void TimeLine::widen() {
  const std::int64_t factor = times_five_ ? 5 : 2;
  times_five_ = !times_five_;
  width_ns_ *= factor;
  std::map<std::int64_t, std::uint64_t> wider;
  for (const auto& [bin, frames] : bins_) {
    wider[bin >= 0 ? bin / factor : -((-bin + factor - 1) / factor)] += frames;
  }
  bins_ = std::move(wider);
}

}  // namespace rubric::stats
