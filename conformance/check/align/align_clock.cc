#include "conformance/check/align/align_clock.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace rubric::check {
namespace {

constexpr std::size_t kFramesMin = 3;
constexpr std::int64_t kSlackUs = 100'000;    // Beyond the response time: a queue, a repetition.
constexpr double kDriftMax = 300e-6;          // Two crystals, with a margin.
constexpr std::size_t kTrack = 9;             // Neighbours that say where the next one lies.
constexpr std::size_t kSlopePoints = 300;     // Enough for a slope; pairs of them are counted.
constexpr std::int64_t kUnwaitedUs = 20'000;  // Even the fastest frame may have waited so long.
constexpr std::int64_t kRoundedUs = 2;        // Rounding may take this from an order.
constexpr double kTrimmed = 0.02;             // Pairs that are a chance, or a message held up.
constexpr double kTickUs = 1000;              // A log may count in milliseconds or ticks.
constexpr std::size_t kStepShare = 10;        // A tenth of the events lies elsewhere: a step.
constexpr double kSigma = 1.4826;             // Scales a median deviation.
constexpr std::size_t kDriftFrames = 8;
constexpr std::int64_t kDriftSpanUs = 10'000'000;
constexpr double kDriftShownUs = 200;  // Less than that, over all, is none.

// One pair: the second file's stamp, how far that clock is ahead, and which way the frame went.
struct Point {
  std::int64_t at_us = 0;
  std::int64_t ahead_us = 0;
  int lag_sign = 0;
  std::int64_t lag_min_us = 0;
  bool up = false;  // From the air to a line.
  bool inlier = false;
  double rest_us = 0;  // The remainder after drift.
};

using Points = std::vector<Point>;

Points points_of(const Run& run, const CommonFrames& common) {
  Points out;
  for (const Pair& pair : common.pairs) {
    const std::int64_t a = run.seen[pair.a].place.time_us;
    const std::int64_t b = run.seen[pair.b].place.time_us;
    if (a == kNoStamp || b == kNoStamp) continue;
    const bool up = pair.how == Common::kUp || pair.how == Common::kJoined;
    out.push_back({b, b - a, pair.lag_sign, pair.lag_min_us, up, false, 0});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Point& x, const Point& y) { return x.at_us < y.at_us; });
  return out;
}

template <class T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Returns the value that `part` (0 to 1) of them do not exceed.
double quantile(std::vector<double> values, double part) {
  const double rank = part * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::llround(rank));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The most points, inliers aside, that lie within `width` of each other.
struct Cluster {
  std::size_t size = 0;
  std::int64_t from_us = 0;
};
Cluster densest(const Points& points, std::int64_t width_us) {
  std::vector<std::int64_t> ahead;
  for (const Point& point : points) {
    if (!point.inlier) ahead.push_back(point.ahead_us);
  }
  std::sort(ahead.begin(), ahead.end());
  Cluster out;
  std::size_t from = 0;
  for (std::size_t to = 0; to < ahead.size(); ++to) {
    while (ahead[to] - ahead[from] > width_us) ++from;
    if (to - from + 1 <= out.size) continue;
    out = {to - from + 1, ahead[from]};
  }
  return out;
}

// Marks the points that continue the densest part, which drift moves slowly.
class Tracking {
 public:
  Tracking(Points& points, std::int64_t width_us) : points_(points), width_us_(width_us) {}

  void track() {
    const Cluster seed = densest(points_, width_us_);
    std::vector<std::size_t> seeds;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const std::int64_t over = points_[i].ahead_us - seed.from_us;
      if (over >= 0 && over <= width_us_) seeds.push_back(i);
    }
    const std::size_t middle = seeds[seeds.size() / 2];
    const std::int64_t start_us = seed.from_us + width_us_ / 2;
    walk(middle, points_.size(), 1, start_us);
    walk(middle, points_.size(), -1, start_us);
  }

 private:
  void walk(std::size_t from, std::size_t size, std::ptrdiff_t step, std::int64_t here_us) {
    std::vector<std::int64_t> last;
    std::int64_t at_us = points_[from].at_us;
    for (std::size_t i = from; i < size; i += static_cast<std::size_t>(step)) {
      Point& point = points_[i];
      const double drifted = kDriftMax * static_cast<double>(std::abs(point.at_us - at_us));
      if (std::abs(point.ahead_us - here_us) > width_us_ / 2 + std::llround(drifted)) continue;
      point.inlier = true;
      at_us = point.at_us;
      if (last.size() == kTrack) last.erase(last.begin());
      last.push_back(point.ahead_us);
      if (last.size() >= kFramesMin) here_us = median(last);
    }
  }

  Points& points_;
  std::int64_t width_us_;
};

// Returns the median slope between pairs that went the same way (Theil and Sen).
double slope_of(const Points& in) {
  std::vector<double> slopes;
  const std::size_t stride = std::max<std::size_t>(1, in.size() / kSlopePoints);
  for (std::size_t i = 0; i < in.size(); i += stride) {
    for (std::size_t j = i + stride; j < in.size(); j += stride) {
      const std::int64_t apart_us = in[j].at_us - in[i].at_us;
      if (in[i].lag_sign != in[j].lag_sign || apart_us < kDriftSpanUs / 10) continue;
      slopes.push_back(static_cast<double>(in[j].ahead_us - in[i].ahead_us) /
                       static_cast<double>(apart_us));
    }
  }
  return slopes.empty() ? 0 : median(std::move(slopes));
}

std::vector<double> rests(const Points& in, int lag_sign) {
  std::vector<double> out;
  for (const Point& point : in) {
    if (point.lag_sign == lag_sign) out.push_back(point.rest_us);
  }
  return out;
}

// Returns how far each point is from the median of those that went the same way.
std::vector<double> deviations(const Points& in) {
  std::vector<double> out;
  for (const int sign : {-1, 0, 1}) {
    const std::vector<double> values = rests(in, sign);
    if (values.empty()) continue;
    const double middle = median(values);
    for (const double value : values) out.push_back(std::abs(value - middle));
  }
  return out;
}

void set_rests(Points& in, std::int64_t base_us, double drift) {
  for (Point& point : in) {
    const double since = static_cast<double>(point.at_us - in.front().at_us);
    point.rest_us = static_cast<double>(point.ahead_us - base_us) - drift * since;
  }
}

// Returns a slope that clocks can have and that the scatter of the points cannot feign, else 0.
// Sets the remainders accordingly.
double drift_of(Points& in, std::int64_t base_us) {
  set_rests(in, base_us, 0);
  const std::int64_t span_us = in.back().at_us - in.front().at_us;
  if (in.size() < kDriftFrames || span_us < kDriftSpanUs) return 0;
  const double slope = slope_of(in);
  set_rests(in, base_us, slope);
  const double sigma = kSigma * median(deviations(in)) + 1;
  const double doubt =
      sigma * std::sqrt(12 / static_cast<double>(in.size())) / static_cast<double>(span_us);
  const double moved_us = std::abs(slope) * static_cast<double>(span_us);
  const double spread_us = quantile(deviations(in), 0.9);
  if (std::abs(slope) > 4 * doubt && std::abs(slope) <= kDriftMax &&
      moved_us > 2 * spread_us + kDriftShownUs) {
    return slope;
  }
  set_rests(in, base_us, 0);
  return 0;
}

// The range of the offset, since no effect comes before its cause.
struct Bounds {
  std::optional<double> low;   // From frames whose cause is in the second file.
  std::optional<double> high;  // From frames whose cause is in the first one.
};

// Returns the least value, ignoring those that are far from all others.
std::optional<double> least(const std::vector<double>& values, double far_us) {
  if (values.empty()) return std::nullopt;
  const double usual = quantile(values, kTrimmed);
  double out = usual;
  for (const double value : values) {
    if (value >= usual - far_us) out = std::min(out, value);
  }
  return out;
}

Bounds bounds_of(const Points& in, const AlignOptions& options) {
  std::vector<double> low;
  std::vector<double> high;
  for (const Point& point : in) {
    if (point.lag_sign < 0) low.push_back(-point.rest_us - static_cast<double>(point.lag_min_us));
    if (point.lag_sign > 0) high.push_back(point.rest_us - static_cast<double>(point.lag_min_us));
  }
  const auto far_us = static_cast<double>(options.skew_us);
  Bounds out{least(low, far_us), least(high, far_us)};
  if (out.low) out.low = -*out.low + static_cast<double>(kRoundedUs);
  if (out.high) out.high = *out.high - static_cast<double>(kRoundedUs);
  return out;
}

// Returns how far the second clock is ahead of remainder 0: as far as frames that are the same say,
// else so that the fastest frame from the air to the line waited for nothing. The line's stamps are
// then as early as they can be, so whatever came down it precedes its effect on the air.
double ahead_of(const Points& in, const AlignOptions& options) {
  const std::vector<double> same = rests(in, 0);
  if (!same.empty()) return median(same);
  const Bounds bounds = bounds_of(in, options);
  const auto up = std::find_if(in.begin(), in.end(), [](const Point& one) { return one.up; });
  if (up != in.end()) return up->lag_sign > 0 ? *bounds.high : *bounds.low;
  const double down_us = kUnwaitedUs / 2.0;
  return bounds.high ? *bounds.high - down_us : *bounds.low + down_us;
}

std::string count_text(std::size_t count) {
  return count == 1 ? "1 frame" : std::to_string(count) + " frames";
}

// The offsets of a clock that let the fewest effects come before their causes.
class CausalRange {
 public:
  explicit CausalRange(const Points& in) {
    for (const Point& point : in) {
      const auto lag = static_cast<double>(point.lag_min_us);
      (point.lag_sign > 0 ? most_ : least_).push_back(point.rest_us - point.lag_sign * lag);
    }
    std::sort(least_.begin(), least_.end());
    std::sort(most_.begin(), most_.end());
    std::vector<double> edges = least_;
    edges.insert(edges.end(), most_.begin(), most_.end());
    for (const double edge : edges) broken = std::min(broken, broken_at(edge));
    std::erase_if(edges, [&](double edge) { return broken_at(edge) > broken; });
    if (edges.empty()) return;
    std::tie(low, high) =
        std::pair(*std::ranges::min_element(edges), *std::ranges::max_element(edges));
    // Where nothing bounds one side, the fastest event waited for little.
    const bool below = !least_.empty() && least_.front() <= low + kTolerated;
    const bool above = !most_.empty() && most_.back() >= high - kTolerated;
    likely = below && above ? (low + high) / 2 : above ? high : low;
    if (!below) low = high - static_cast<double>(kUnwaitedUs);
    if (!above) high = low + static_cast<double>(kUnwaitedUs);
  }

  // Returns how many effects come before their causes.
  std::size_t broken_at(double offset_us) const {
    const auto late = std::ranges::upper_bound(least_, offset_us + kTolerated);
    const auto early = std::ranges::lower_bound(most_, offset_us - kTolerated);
    return static_cast<std::size_t>(least_.end() - late + (early - most_.begin()));
  }

  // Narrows a range around 0 to where no more of them do.
  void around_zero(double& from, double& to) const {
    for (const double edge : least_) {
      if (edge <= kTolerated) from = std::max(from, std::min(edge, 0.0));
    }
    for (const double edge : most_) {
      if (edge >= -kTolerated) to = std::min(to, std::max(edge, 0.0));
    }
  }

  // Returns by how much events contradict each other.
  double contradiction() const {
    if (broken == 0 || least_.empty() || most_.empty()) return 0;
    return std::max(0.0, least_.back() - most_.front());
  }

  std::size_t broken = SIZE_MAX;
  double low = 0;
  double high = 0;
  double likely = 0;

 private:
  static constexpr double kTolerated = kRoundedUs;
  std::vector<double> least_;  // From lines of the log that cause a frame.
  std::vector<double> most_;   // From those that tell of one.
};

class Fit {
 public:
  Fit(const Run& run, const CommonFrames& common, const AlignOptions& options)
      : run_(run), common_(common), options_(options), points_(points_of(run, common)) {}

  ClockFit fit() {
    if ((points_.empty() ? guesses_near_zero() : near_zero()) && guesses_in_order()) {
      if (steps(0, 0)) return unsure(kSteps);
      out_.clocks = Clocks::kAgree;
      out_.frames = points_.size();
      fit_same();
      return out_;
    }
    if (points_.empty()) {
      return unsure(common_.guesses.empty() ? "no frame is in both"
                                            : "the frames that are in both repeat, so that each "
                                              "could be another one");
    }
    if (!find_inliers()) return out_;
    if (!covers()) {
      return unsure("the " + count_text(in_.size()) +
                    " that are in both are fewer than those of the same time that are not");
    }
    if (steps(in_.front().ahead_us, in_.back().ahead_us)) return unsure(kSteps);
    return judge();
  }

  ClockFit fit_log(bool own_zero) {
    const auto skew_us = static_cast<double>(options_.skew_us);
    out_.frames = points_.size();
    set_rests(points_, 0, 0);
    const CausalRange all(points_);
    if (!own_zero && at_zero() && (points_.empty() || all.broken_at(0) == all.broken)) {
      double low = -skew_us;
      double high = skew_us;
      all.around_zero(low, high);
      const double doubt = doubt_us(points_, all);
      out_.clocks = Clocks::kAgree;
      out_.earlier_us = std::llround(std::min(high + doubt, skew_us));
      out_.slack_us = std::llround(std::min(doubt - low, skew_us));
      return out_;
    }
    if (points_.empty()) return unsure("no event is in both");
    if (!find_inliers()) return out_;
    const std::size_t others = points_.size() - in_.size();
    if (others >= kFramesMin && kStepShare * others > points_.size()) return unsure(kSteps);
    const std::int64_t base_us = in_.front().ahead_us;
    out_.drift = drift_of(in_, base_us);
    out_.spread_us = quantile(deviations(in_), 0.9);
    const CausalRange range(in_);
    if (4 * range.broken > in_.size()) {
      return unsure("some of the frames that are in both would come before their causes");
    }
    const double doubt = doubt_us(in_, range);
    if (doubt > skew_us) return unsure("its events and frames contradict each other");
    out_.clocks = Clocks::kDiffer;
    out_.offset_us = base_us + std::llround(range.likely);
    out_.earlier_us = std::llround(range.high - range.likely + doubt);
    out_.slack_us = std::llround(range.likely - range.low + doubt);
    out_.at_us = in_.front().at_us;
    out_.frames = in_.size();
    return out_;
  }

 private:
  // Returns whether most events of a log come as near their frames as if it had the same clock.
  bool at_zero() const {
    const std::int64_t most = options_.response_us + kSlackUs + options_.skew_us;
    const auto far = std::ranges::count_if(
        points_, [&](const Point& point) { return std::abs(point.ahead_us) > most; });
    return kStepShare * static_cast<std::size_t>(far) <= points_.size();
  }

  // Returns how much more than one offset allows a pair may be off: by unseen drift, by the tick of
  // a log, and by all that contradicts where so much does that stamps must scatter.
  static double doubt_us(const Points& in, const CausalRange& range) {
    const double most = range.contradiction();
    if (static_cast<double>(range.broken) > kTrimmed * static_cast<double>(in.size())) {
      return most + kTickUs;
    }
    if (in.empty()) return kTickUs;
    const double drifted = kDriftMax * static_cast<double>(in.back().at_us - in.front().at_us);
    const double spread = 2 * quantile(deviations(in), 0.9) + kDriftShownUs;
    return kTickUs + std::min({most, drifted, spread});
  }

  // Finds the pairs that agree. Returns false, having said why, if they are too few.
  bool find_inliers() {
    if (points_.size() < kFramesMin) {
      unsure("only " + count_text(points_.size()) + (points_.size() == 1 ? " is" : " are") +
             " in both, and " + std::to_string(kFramesMin) + " are needed");
      return false;
    }
    const std::int64_t width_us = 2 * (options_.response_us + kSlackUs);
    Tracking(points_, width_us).track();
    for (const Point& point : points_) {
      if (point.inlier) in_.push_back(point);
    }
    const std::size_t other = densest(points_, width_us).size;
    if (in_.size() >= kFramesMin && 2 * in_.size() > points_.size() && 2 * other <= in_.size()) {
      return true;
    }
    unsure("the " + count_text(points_.size()) + " that are in both do not lie equally far apart");
    return false;
  }

  static constexpr const char* kSteps = "its clock steps, or many events are in one of them only";

  // Returns whether the first pairs, or the last ones, agree on another shift than those after or
  // before them.
  bool steps(std::int64_t first_us, std::int64_t last_us) const {
    const std::int64_t most_us = options_.response_us + kSlackUs + options_.skew_us;
    const auto in_a_row = [&](auto from, auto to, std::int64_t ahead_us) {
      const auto end = std::find_if(from, to, [&](const Point& point) {
        return std::abs(point.ahead_us - ahead_us) <= most_us;
      });
      if (static_cast<std::size_t>(end - from) < kFramesMin) return false;
      const auto [low, high] = std::minmax_element(
          from, end, [](const Point& a, const Point& b) { return a.ahead_us < b.ahead_us; });
      return high->ahead_us - low->ahead_us <= most_us;
    };
    return in_a_row(points_.begin(), points_.end(), first_us) ||
           in_a_row(points_.rbegin(), points_.rend(), last_us);
  }

  ClockFit unsure(std::string why) {
    out_.clocks = Clocks::kUnsure;
    out_.why = std::move(why);
    return out_;
  }

  // Returns whether most pairs look like those of one clock, so that nothing needs to be shown.
  bool near_zero() const {
    Points near;
    const std::int64_t most = options_.response_us + kSlackUs + options_.skew_us;
    for (const Point& point : points_) {
      if (std::abs(point.ahead_us) > most) continue;
      near.push_back(point);
    }
    if (2 * near.size() <= points_.size()) return false;
    const auto span_us = static_cast<double>(near.back().at_us - near.front().at_us);
    const double drifted = std::abs(drift_of(near, 0)) * span_us;
    set_rests(near, 0, 0);
    const auto skew_us = static_cast<double>(options_.skew_us);
    if (drifted > skew_us || std::abs(ahead_of(near, options_)) > skew_us) return false;
    // Clocks so near each other may still put an effect before its cause.
    const auto early = std::ranges::count_if(
        near, [](const Point& p) { return p.lag_sign * p.ahead_us < -kRoundedUs; });
    return static_cast<double>(early) <= kTrimmed * static_cast<double>(near.size());
  }

  // Says how far clocks that agree are apart by frames that are the same in both.
  void fit_same() {
    const std::int64_t most_us = options_.response_us + kSlackUs + options_.skew_us;
    Points same;
    std::ranges::copy_if(points_, std::back_inserter(same), [&](const Point& point) {
      return point.lag_sign == 0 && std::abs(point.ahead_us) <= most_us;
    });
    out_.same = same.size() >= kFramesMin;
    if (!out_.same) return;
    out_.drift = drift_of(same, 0);
    out_.offset_us = std::llround(ahead_of(same, options_));
    out_.at_us = same.front().at_us;
  }

  // Returns whether most repeating frames can be pairs of one clock.
  bool guesses_near_zero() const {
    std::map<std::uint32_t, bool> near;  // By frame index in the second file.
    for (const Pair& pair : common_.guesses) {
      const std::int64_t a = run_.seen[pair.a].place.time_us;
      const std::int64_t b = run_.seen[pair.b].place.time_us;
      if (a == kNoStamp || b == kNoStamp) continue;
      const std::int64_t later_us = pair.lag_sign < 0 ? a - b : b - a;
      const std::int64_t most_us = pair.lag_sign == 0 ? 0 : options_.response_us;
      bool& good = near[pair.b];
      good = good || (later_us >= -options_.skew_us && later_us <= most_us + options_.skew_us);
    }
    const auto count =
        std::count_if(near.begin(), near.end(), [](const auto& one) { return one.second; });
    return 2 * static_cast<std::size_t>(count) > near.size();
  }

  // Returns whether each repeating frame that is near one that it could be has its cause before it.
  bool guesses_in_order() const {
    std::map<std::uint32_t, std::pair<bool, bool>> near;  // By frame index in the second file.
    for (const Pair& pair : common_.guesses) {
      const std::int64_t a = run_.seen[pair.a].place.time_us;
      const std::int64_t b = run_.seen[pair.b].place.time_us;
      if (a == kNoStamp || b == kNoStamp || pair.lag_sign == 0) continue;
      const std::int64_t later_us = pair.lag_sign * (b - a);
      auto& [early, in_order] = near[pair.b];
      early = early || (later_us < -kRoundedUs && later_us >= -options_.skew_us);
      in_order = in_order || (later_us >= -kRoundedUs && later_us <= options_.response_us);
    }
    return std::ranges::none_of(
        near, [](const auto& one) { return one.second.first && !one.second.second; });
  }

  // Returns whether, in the time that both files cover, at least one of them misses no more frames
  // of the other than it shares with it.
  bool covers() const {
    const std::int64_t ahead_us = in_[in_.size() / 2].ahead_us;
    const auto at = [&](std::uint32_t index) { return run_.seen[index].place.time_us; };
    const Extent of_a = extent(common_.only_a, true);
    const Extent of_b = extent(common_.only_b, false);
    const auto within = [&](std::int64_t time_us) {  // On the second clock.
      return time_us >= std::max(of_a.first_us + ahead_us, of_b.first_us) - kSlackUs &&
             time_us <= std::min(of_a.last_us + ahead_us, of_b.last_us) + kSlackUs;
    };
    std::size_t only_a = 0;
    std::size_t only_b = 0;
    for (const std::uint32_t i : common_.only_a) {
      only_a += at(i) != kNoStamp && within(at(i) + ahead_us) ? 1 : 0;
    }
    for (const std::uint32_t i : common_.only_b) {
      only_b += at(i) != kNoStamp && within(at(i)) ? 1 : 0;
    }
    return in_.size() >= std::min(only_a, only_b);
  }

  struct Extent {
    std::int64_t first_us = 0;
    std::int64_t last_us = 0;
  };
  Extent extent(const std::vector<std::uint32_t>& only, bool of_a) const {
    const std::int64_t start_us = in_.front().at_us - (of_a ? in_.front().ahead_us : 0);
    Extent out{start_us, start_us};
    const auto add = [&](std::uint32_t index) {
      const std::int64_t time_us = run_.seen[index].place.time_us;
      if (time_us == kNoStamp) return;
      out.first_us = std::min(out.first_us, time_us);
      out.last_us = std::max(out.last_us, time_us);
    };
    for (const std::uint32_t index : only) add(index);
    for (const Pair& pair : common_.pairs) add(of_a ? pair.a : pair.b);
    return out;
  }

  ClockFit judge() {
    const std::int64_t base_us = in_.front().ahead_us;
    out_.drift = drift_of(in_, base_us);
    out_.spread_us = quantile(deviations(in_), 0.9);
    if (out_.spread_us > static_cast<double>(options_.response_us)) {
      return unsure("the " + count_text(in_.size()) + " that are in both lie up to " +
                    std::to_string(std::llround(out_.spread_us / 1000)) + " ms apart");
    }
    const Bounds bounds = bounds_of(in_, options_);
    if (bounds.low && bounds.high &&
        *bounds.low - *bounds.high > static_cast<double>(options_.skew_us)) {
      return unsure("some of the frames that are in both would come before their causes");
    }
    out_.clocks = Clocks::kDiffer;
    out_.same = rests(in_, 0).size() >= kFramesMin;
    out_.offset_us = base_us + std::llround(ahead_of(in_, options_));
    if (bounds.low && bounds.high) {
      out_.slack_us = std::max<std::int64_t>(0, std::llround(*bounds.high - *bounds.low));
    } else if (rests(in_, 0).empty()) {
      out_.slack_us = kUnwaitedUs;
    }
    out_.at_us = in_.front().at_us;
    out_.frames = in_.size();
    return out_;
  }

  const Run& run_;
  const CommonFrames& common_;
  const AlignOptions& options_;
  Points points_;
  Points in_;
  ClockFit out_;
};

}  // namespace

std::int64_t ClockFit::moved(std::int64_t time_us) const {
  const double since = static_cast<double>(time_us - at_us);
  return time_us - offset_us - std::llround(drift * since);
}

std::int64_t ClockFit::moved_back(std::int64_t time_us) const {
  const double since = static_cast<double>(time_us + offset_us - at_us);
  return time_us + offset_us + std::llround(drift * since);
}

ClockFit fit_clock(const Run& run, const CommonFrames& common, const AlignOptions& options) {
  return Fit(run, common, options).fit();
}

ClockFit fit_log(const Run& run, const CommonFrames& common, const AlignOptions& options,
                 bool own_zero) {
  return Fit(run, common, options).fit_log(own_zero);
}

}  // namespace rubric::check
