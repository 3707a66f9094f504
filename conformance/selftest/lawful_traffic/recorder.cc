// Recorders: their clocks step, drift, are coarse, or fail once; or they miss packets of every tap,
// or hand them on late or turned round.
#include "conformance/selftest/lawful_traffic/recorder.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace rubric::lawful {
namespace {

constexpr std::int64_t kEpochUs = 20'000'000'000;  // A clock that can step back.
constexpr std::int64_t kStepMinUs = 20'000;
constexpr std::int64_t kBackMinUs = 1'200'000;
constexpr std::size_t kStepOrders = 17;
constexpr std::int64_t kDriftPpm = 500;
constexpr std::int64_t kCoarseUs = 50'000;
constexpr std::int64_t kLateUs = 20'000;
constexpr std::int64_t kTurnedUs = 5'000;

// Returns a size from 20 ms to 44 minutes; each order of magnitude is as likely.
std::int64_t forth_us(Random& random) {
  const std::int64_t order = kStepMinUs << random.below(kStepOrders);
  return order + random.between(0, order);
}
// The same, from 1.2 s on: back by less than the time that nodes wait hides in a silence.
std::int64_t back_us(Random& random) { return std::max(forth_us(random), kBackMinUs); }

// Moves the stamps of `count` packets from a random one on; SIZE_MAX: of all that follow.
void move_some(Traffic& traffic, Random& random, std::int64_t by_us, std::size_t count) {
  if (traffic.packets.empty()) return;
  const std::size_t first = random.below(traffic.packets.size());
  for (std::size_t i = first; i < traffic.packets.size() && i - first < count; ++i) {
    traffic.packets[i].time_us += by_us;
  }
}

void exact(Traffic&, Random&) {}
void steps_back(Traffic& traffic, Random& random) {
  move_some(traffic, random, -back_us(random), SIZE_MAX);
}
void steps_forth(Traffic& traffic, Random& random) {
  move_some(traffic, random, forth_us(random), SIZE_MAX);
}
void steps_often(Traffic& traffic, Random& random) {
  for (int i = 0; i < 4; ++i) {
    const std::int64_t by_us = random.chance(50) ? forth_us(random) : -back_us(random);
    move_some(traffic, random, by_us, SIZE_MAX);
  }
}
void wrong_stamp(Traffic& traffic, Random& random) {
  const std::int64_t by_us = back_us(random);
  move_some(traffic, random, random.chance(50) ? by_us : -by_us, 1);
}
void drifts(Traffic& traffic, Random& random) {
  const std::int64_t ppm = random.chance(50) ? kDriftPpm : -kDriftPpm;
  for (LawfulPacket& packet : traffic.packets) {
    packet.time_us += (packet.time_us - kEpochUs) * ppm / 1'000'000;
  }
}
void drop(Traffic& traffic, Random& random, int percent) {
  bool first = true;  // It stays, so that a cold start remains one.
  std::erase_if(traffic.packets, [&](const LawfulPacket&) {
    return !std::exchange(first, false) && random.chance(percent);
  });
  traffic.sniffer_complete = false;
}
void drops(Traffic& traffic, Random& random) { drop(traffic, random, 20); }
void drops_few(Traffic& traffic, Random& random) { drop(traffic, random, 5); }
void drops_on_lines(Traffic& traffic, Random& random) {
  std::erase_if(traffic.packets, [&](const LawfulPacket& packet) {
    return packet.interface != "radio" && random.chance(20);
  });
  traffic.sniffer_complete = false;
}
void drops_and_steps(Traffic& traffic, Random& random) {
  drops(traffic, random);
  steps_often(traffic, random);
}
void radio_alone(Traffic& traffic, Random&) {
  std::erase_if(traffic.packets,
                [](const LawfulPacket& packet) { return packet.interface != "radio"; });
}

void begins_late(Traffic& traffic, Random& random) {
  const auto begin = traffic.packets.begin();
  traffic.packets.erase(
      begin, begin + static_cast<std::ptrdiff_t>(random.below(traffic.packets.size() / 2 + 1)));
  traffic.cold_start = false;
}
void coarse_stamps(Traffic& traffic, Random&) {
  for (LawfulPacket& packet : traffic.packets) packet.time_us -= packet.time_us % kCoarseUs;
}
// Hands on what is on lines late, each line in its order.
void late_lines(Traffic& traffic, Random& random) {
  std::map<std::string, std::int64_t> last;
  for (LawfulPacket& packet : traffic.packets) {
    if (packet.interface == "radio") continue;
    std::int64_t& latest = last[packet.interface];
    latest = std::max(latest, packet.time_us + kLateUs + random.between(0, kLateUs / 4));
    packet.time_us = latest;
  }
  std::ranges::stable_sort(traffic.packets, {}, &LawfulPacket::time_us);
}
// Writes neighbours on the air in the other order, with their stamps.
void turns(Traffic& traffic, Random& random) {
  for (std::size_t i = 0; i + 1 < traffic.packets.size(); ++i) {
    LawfulPacket& first = traffic.packets[i];
    LawfulPacket& second = traffic.packets[i + 1];
    const bool near = second.time_us - first.time_us <= kTurnedUs && first.interface == "radio" &&
                      second.interface == "radio";
    if (!near || !random.chance(5)) continue;
    std::swap(first, second);
    ++i;
  }
}

constexpr Recorder kRecorders[] = {
    {"exact", "every packet with its time", exact},
    {"steps_back", "the clock steps back once, by 1.2 s to 44 minutes", steps_back},
    {"steps_forth", "the clock steps forth once, by 20 ms to 44 minutes", steps_forth},
    {"steps_often", "the clock steps four times, back or forth", steps_often},
    {"wrong_stamp", "one stamp is wrong by 1.2 s to 44 minutes", wrong_stamp},
    {"drifts", "the clock is wrong by 500 ppm", drifts},
    {"drops", "a fifth of all packets is missing, on the air and on lines", drops},
    {"drops_few", "a twentieth is missing", drops_few},
    {"drops_on_lines", "a fifth of what is on lines alone is missing", drops_on_lines},
    {"drops_and_steps", "a fifth is missing, and the clock steps four times", drops_and_steps},
    {"radio_alone", "what is on the air alone", radio_alone},
    {"begins_late", "up to half of the packets are over when it begins", begins_late},
    {"coarse_stamps", "stamps are whole steps of 50 ms apart", coarse_stamps},
    {"late_lines", "what is on lines comes 20 to 25 ms late", late_lines},
    {"turns", "a twentieth of close neighbours on the air is written in the other order", turns},
};

}  // namespace

std::span<const Recorder> recorders() { return kRecorders; }

void record(Traffic& traffic, std::string_view recorder, std::uint64_t seed) {
  for (const Recorder& one : kRecorders) {
    if (one.name != recorder) continue;
    if (one.record == exact) return;
    for (LawfulPacket& packet : traffic.packets) packet.time_us += kEpochUs;
    Random random(seed);
    one.record(traffic, random);
    return;
  }
  throw std::invalid_argument("no recorder is named " + std::string(recorder));
}

}  // namespace rubric::lawful
