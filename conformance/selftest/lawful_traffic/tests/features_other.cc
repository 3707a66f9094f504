// Features that variants of channels, clocks and captures must show.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "conformance/selftest/lawful_traffic/tests/seen.h"

namespace rubric::lawful {
namespace {

using rubicon::AmType;
using rubicon::Component;

constexpr std::int64_t kPeriodUs = 488'281;
constexpr std::int64_t kJitterUs = 20'000;

bool usual(const Traffic&, const Frames& f) {
  return count(f, [](const Seen& s) { return s.radio && s.body_type() == 35; }) > 20 &&
         count(f, [](const Seen& s) { return s.serial_joined(); }) == 3;
}

/// Returns a node's frames on its channel to `dest`.
Frames channel(const Frames& f, std::uint16_t from, std::uint16_t dest) {
  return pick(f, [&](const Seen& s) {
    return s.radio && s.app(Component::kSynChannel) && s.am_src == from &&
           s.net->dest.devid == dest;
  });
}
bool channel_app(const Frames& f, std::uint8_t app) {
  const Frames data = channel(f, 2, 1);
  return data.size() > 8 && data[0].net->payload.size() == 14 &&
         channel(f, 2, 3).at(0).net->payload.size() == 42 && channel(f, 3, 3).empty() &&
         std::all_of(data.begin(), data.end(),
                     [&](const Seen& s) { return s.net->payload[1] == app && !s.net->reliable; });
}
std::size_t same_as_before(const Frames& data) {
  std::size_t out = 0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    if (data[i].net->payload == data[i - 1].net->payload) ++out;
  }
  return out;
}
bool near_multiple(std::int64_t gap) {
  const std::int64_t rest = gap % kPeriodUs;
  return std::min(rest, kPeriodUs - rest) < kJitterUs;
}
bool all_gaps(const Frames& data, bool (*holds)(std::int64_t)) {
  const auto some = gaps(data);
  return !some.empty() && std::all_of(some.begin(), some.end(), holds);
}
bool one_period(std::int64_t gap) { return std::abs(gap - kPeriodUs) < kJitterUs; }
std::int64_t longest(const Frames& data) {
  const auto some = gaps(data);
  return *std::max_element(some.begin(), some.end());
}
bool constant(const Traffic&, const Frames& f) {
  const Frames data = channel(f, 2, 1);
  return data.size() > 8 && same_as_before(data) == data.size() - 1 && all_gaps(data, one_period);
}
bool power_save(const Traffic&, const Frames& f) {
  const Frames data = channel(f, 2, 3);
  return !data.empty() && data.size() < 13 && same_as_before(data) == 0 &&
         all_gaps(data, near_multiple) && longest(data) > 2 * kPeriodUs - kJitterUs;
}
bool stop_restart(const Traffic&, const Frames& f) {
  return longest(channel(f, 2, 1)) > 2'000'000 && all_gaps(channel(f, 2, 1), near_multiple) &&
         all_gaps(channel(f, 2, 3), one_period);
}
bool restart_power_save(const Traffic&, const Frames& f) {
  return longest(channel(f, 2, 1)) > 2'000'000 && any(channel(f, 2, 1), [](const Seen& s) {
           return s.time_us > 7'100'000 && s.time_us < 7'100'000 + kPeriodUs + kJitterUs;
         });
}
bool restart_shifts(const Traffic&, const Frames& f) {
  const auto other = gaps(channel(f, 2, 3));
  return std::any_of(other.begin(), other.end(), [](std::int64_t gap) {
    return gap > kPeriodUs + kJitterUs && !near_multiple(gap);
  });
}
bool no_phase(const Traffic&, const Frames& f) {
  const auto first = channel(f, 2, 1).at(0).time_us;
  const auto second = channel(f, 3, 1).at(0).time_us;
  return std::abs(first - second) < kJitterUs;
}
bool slower_clock(const Traffic&, const Frames& f) {
  return all_gaps(channel(f, 2, 1), [](std::int64_t gap) { return gap > 950'000; });
}
bool faster_clock(const Traffic&, const Frames& f) {
  return all_gaps(channel(f, 2, 1), [](std::int64_t gap) { return gap < 270'000; });
}

/// Returns the longest time from a request to its reply.
std::int64_t slowest_reply(const Frames& f) {
  std::int64_t out = 0;
  std::map<std::uint16_t, std::int64_t> asked;
  for (const Seen& s : f) {
    if (s.is(AmType::kJoin)) asked[s.am_src] = s.time_us;
    if (s.is(AmType::kJoinReply)) out = std::max(out, s.time_us - asked[s.am_dst]);
  }
  return out;
}
bool slow(const Traffic&, const Frames& f) {
  return slowest_reply(f) > 100'000 && slowest_reply(f) < 300'000;
}
/// Returns the mean time between requests of mote 2.
std::int64_t mean_gap(const Frames& f) {
  const Frames sent = requests(f, 2);
  if (sent.size() < 4) return 0;
  return (sent.back().time_us - sent.front().time_us) / static_cast<std::int64_t>(sent.size() - 1);
}
bool timers_slow(const Traffic&, const Frames& f) {
  return mean_gap(f) > kPeriodUs * 1014 / 1000 && mean_gap(f) < kPeriodUs * 1023 / 1000;
}
bool timers_fast(const Traffic&, const Frames& f) {
  const auto some = gaps(requests(f, 2));
  return mean_gap(f) > 0 && mean_gap(f) < kPeriodUs * 975 / 1000 &&
         *std::min_element(some.begin(), some.end()) >= 458'000;
}
bool timers_real(const Traffic&, const Frames& f) {
  return std::abs(mean_gap(f) - 500'000) < 4'000;
}
/// Returns the growth of cur_time from the first to the last reply of the sink, and the time that
/// passed.
std::pair<std::uint32_t, std::int64_t> clock_growth(const Frames& f) {
  const Frames some = pick(f, [](const Seen& s) { return s.is(AmType::kJoinReply); });
  return {some.back().cur_time() - some.front().cur_time(),
          some.back().time_us - some.front().time_us};
}
bool grows_by(const Frames& f, double per_ms) {
  const auto [grown, passed_us] = clock_growth(f);
  const double expected = static_cast<double>(passed_us) / 1000 * per_ms;
  return passed_us > 5'000'000 && std::abs(grown - expected) < 15;
}
bool skew(const Traffic&, const Frames& f) {
  const Frames some = pick(f, [](const Seen& s) { return s.is(AmType::kJoinReply); });
  const auto ms = static_cast<std::int64_t>(some[0].cur_time());
  return std::abs(ms - some[0].time_us / 1000) > 1000;
}
bool wraps(const Traffic&, const Frames& f) {
  const Frames some = pick(f, [](const Seen& s) { return s.is(AmType::kJoinReply); });
  return grows_by(f, 1) && some.back().cur_time() < some.front().cur_time();
}
bool busy(const Traffic&, const Frames& f) {
  const auto some = gaps(requests(f, 2));
  const auto [low, high] = std::minmax_element(some.begin(), some.end());
  return *low >= 458'000 && *high - *low > 8'000;
}

bool stated_join_timer(const Traffic&, const Frames& f) {
  return std::abs(mean_gap(f) - 292'969) < 8'000;
}
bool stated_slow_join_timer(const Traffic&, const Frames& f) {
  return std::abs(mean_gap(f) - 1'000'000) < 8'000;
}
bool stated_requests(const Traffic&, const Frames& f) {
  return requests(f, 2).size() > 5 && distinct_seqs(requests(f, 2)) == 1;
}
bool stated_slow(const Traffic&, const Frames& f) {
  return slowest_reply(f) > 330'000 && slowest_reply(f) < 480'000;
}
bool stated_busy(const Traffic&, const Frames& f) {
  const auto some = gaps(requests(f, 2));
  const auto [low, high] = std::minmax_element(some.begin(), some.end());
  return *low >= 395'000 && *high - *low > 20'000;
}

bool foreign(const Traffic&, const Frames& f) {
  return any(f, [](const Seen& s) { return s.radio && s.am_type == 0x70; }) &&
         any(f, [](const Seen& s) { return s.radio && s.am_type == 0x3E; });
}
bool beacons(const Traffic&, const Frames& f) {
  std::set<std::uint8_t> anchors;
  for (const Seen& s : f) {
    if (s.radio && s.is(AmType::kTemp)) anchors.insert(s.payload.at(0));
  }
  return anchors.size() == 5;
}
bool corrupt(const Traffic&, const Frames& f) {
  return count(f, [](const Seen& s) { return s.radio && !s.sum_ok; }) >= 3;
}
bool lossy(const Traffic&, const Frames& f) {
  const auto forwarded = count(f, [](const Seen& s) { return !s.radio && s.body_type() == 35; });
  const auto sent = count(f, [](const Seen& s) { return s.radio && s.body_type() == 35; });
  return forwarded * 10 < sent * 9;
}
bool sniffer_gaps(const Traffic& t, const Frames& f) {
  const auto forwarded = count(f, [](const Seen& s) { return !s.radio && s.body_type() == 35; });
  const auto sent = count(f, [](const Seen& s) { return s.radio && s.body_type() == 35; });
  return !t.sniffer_complete && forwarded > sent;
}
bool middle(const Traffic& t, const Frames& f) {
  return !t.cold_start && f.at(0).time_us >= 700'000;
}
bool radio_only(const Traffic&, const Frames& f) {
  return !f.empty() && !any(f, [](const Seen& s) { return !s.radio; });
}
bool serial_only(const Traffic&, const Frames& f) {
  return !f.empty() && !any(f, [](const Seen& s) { return s.radio; });
}

}  // namespace

const std::vector<Feature>& other_features() {
  static const std::vector<Feature> kFeatures = {
      {"usual", usual},
      {"syn_esn_data", [](auto&, auto& f) { return channel_app(f, 11); }},
      {"syn_learning", [](auto&, auto& f) { return channel_app(f, 6); }},
      {"syn_constant", constant},
      {"syn_power_save", power_save},
      {"syn_stop_restart", stop_restart},
      {"syn_restart_power_save", restart_power_save},
      {"syn_restart_shifts", restart_shifts},
      {"syn_no_phase_shift", no_phase},
      {"syn_slower_clock", slower_clock},
      {"syn_faster_clock", faster_clock},
      {"slow", slow},
      {"timers_slow", timers_slow},
      {"timers_fast", timers_fast},
      {"timers_real_ms", timers_real},
      {"clock_skew", skew},
      {"cur_time_binary", [](auto&, auto& f) { return grows_by(f, 1.024); }},
      {"cur_time_wraps", wraps},
      {"cur_time_uptime", [](auto& t, auto& f) { return grows_by(f, 1) && skew(t, f); }},
      {"busy_channel", busy},
      {"stated_join_timer", stated_join_timer},
      {"stated_slow_join_timer", stated_slow_join_timer},
      {"stated_requests", stated_requests},
      {"stated_slow", stated_slow},
      {"stated_busy_channel", stated_busy},
      {"foreign_protocols", foreign},
      {"rssi_beacons", beacons},
      {"corrupt_frames", corrupt},
      {"lossy", lossy},
      {"sniffer_gaps", sniffer_gaps},
      {"starts_in_middle", middle},
      {"radio_only", radio_only},
      {"serial_only", serial_only},
  };
  return kFeatures;
}

}  // namespace rubric::lawful
