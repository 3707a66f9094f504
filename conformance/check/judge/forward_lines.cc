// What a sink has heard and owes on each of its lines; forward.cc and forward_up.cc judge what it
// sends.
#include <algorithm>

#include "conformance/check/judge/forward.h"

namespace rubric::check {
namespace {

using machine::Role;

constexpr std::int64_t kIslandSlackUs = 1'000'000;

}  // namespace

Forwarding::Forwarding(Context& context) : context_(context) {
  for (std::size_t i = 0; i < context.who.devices.size(); ++i) {
    const Device& device = context.who.devices[i];
    if (device.role != Role::kSink || !device.known) continue;
    Line& line = lines_.emplace_back();
    line.sink = static_cast<std::uint16_t>(i);
    line.am = device.am;
    line.island = device.set_later ? kNoIsland : device.island;
    line.serial = device.shows_line();
    line.told = !context.options.start_cold;
    const std::int64_t response_us = context.response_us(line.sink);
    line.slack_us = device.whole ? response_us : std::max(kIslandSlackUs, response_us);
  }
}

bool Forwarding::Line::changing(std::int64_t time_us) const {
  return std::abs(time_us - island_changed_us) < slack_us;
}

bool Forwarding::holds(const Way& way, const Net& net, bool waiting) {
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Passing& passing = way.newest(i);
    const bool wanted = !waiting || passing.passed < passing.copies;
    if (wanted && same_message(passing.net, net)) return true;
  }
  return false;
}

Forwarding::Line* Forwarding::find(std::uint16_t sink) {
  const auto found = std::ranges::find(lines_, sink, &Line::sink);
  return found == lines_.end() ? nullptr : &*found;
}

void Forwarding::set_island(std::uint16_t sink, std::uint16_t island, std::int64_t now_us,
                            bool sure) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->told = true;
  change_island(*line, island, now_us, sure);
}

void Forwarding::acts(std::uint16_t sink, std::uint16_t island, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  change_island(*line, island, now_us, true);
  line->island_sure = true;
  line->island_shown_us = now_us;
}

void Forwarding::change_island(Line& line, std::uint16_t island, std::int64_t now_us, bool sure) {
  if (line.island == island) return;
  // It may pass on as the sink of either island what still waits.
  forget_owed(line.up);
  forget_owed(line.down);
  line.island_changed_us = now_us;
  line.island_sure = sure;
  line.last_island = line.island;
  line.island = island;
}

void Forwarding::perhaps_told(std::uint16_t sink) {
  if (Line* const line = find(sink)) line->island_sure = false;
}

void Forwarding::begin_life(std::uint16_t sink, std::int64_t since_us) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  const auto later = [&](const Passing& one) { return one.last_us >= since_us; };
  line->up.keep_newest(later);
  line->down.keep_newest(later);
  forget_owed(line->up);
  forget_owed(line->down);
  line->up.forgotten = line->down.forgotten = 0;
  line->off = line->deaf = false;
  if (context_.device(sink).hearing) line->island = context_.device(sink).island;
}

void Forwarding::serial_set(std::uint16_t sink, bool on) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->off = !on;
  if (!on) forget_owed(line->up);
}

void Forwarding::forget_owed(Way& way) {
  for (std::size_t i = 0; i < way.size(); ++i) way.newest(i).owed = false;
  way.owed = 0;
}

void Forwarding::radio_set(std::uint16_t sink, bool on) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->deaf = !on;
  if (!on) forget_owed(line->down);
}

void Forwarding::store(Way& way, const Passing& passing) {
  if (way.full() && way.oldest(0).owed) {
    --way.owed;
    ++way.forgotten;
  }
  const std::size_t newer = way.newer_than(passing.net.seq_num);
  Passing& stored = way.push(passing, passing.net.seq_num);
  stored.last_us = passing.place.time_us;
  if (passing.owed) ++way.owed;
  for (std::size_t i = newer + 1; i < std::min(way.size(), kTwinsLook); ++i) {
    Passing& other = way.newest(i);
    if (!same_message(other.net, stored.net)) continue;
    other.twin = stored.twin = true;
    return;
  }
}

void Forwarding::repeated(const Net& net, std::uint16_t sink, std::int64_t now_us) {
  for (Line& line : lines_) {
    if (sink != kNobody && line.sink != sink) continue;
    Way& way = sink == kNobody ? line.up : line.down;
    for (std::size_t i = 0; i < std::min(way.size(), kTwinsLook); ++i) {
      Passing& passing = way.newest(i);
      if (!same_message(passing.net, net)) continue;
      if (passing.copies < 255) ++passing.copies;
      passing.twin = true;
      passing.last_us = now_us;
      // It may be sent on already, if the two taps' clocks differ.
      Ring<Passing, kEarlyRoom>& early = sink == kNobody ? line.early : line.ahead;
      for (std::size_t k = 0; k < early.size(); ++k) {
        Passing& before = early.oldest(k);
        if (before.passed != 0 || !same_message(before.net, net)) continue;
        before.passed = 1;
        ++passing.passed;
        break;
      }
      break;
    }
  }
}

void Forwarding::surely_down(std::uint16_t sink, const Net& net, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    Passing& passing = line->down.newest(i);
    if (!same_message(passing.net, net)) continue;
    passing.sure = passing.came = true;
    passing.whole_us = std::max(passing.whole_us, now_us);
    if (passing.owes && !passing.owed && passing.passed == 0) {
      passing.owed = true;
      ++line->down.owed;
    }
    return;
  }
}

void Forwarding::somebody_sent(const Net& net) {
  for (Line& line : lines_) {
    if (context_.device(line.sink).whole) continue;  // Its log would have it.
    for (std::size_t i = 0; i < line.down.size(); ++i) {
      Passing& passing = line.down.newest(i);
      if (!same_message(passing.net, net)) continue;
      if (passing.owed) --line.down.owed;
      passing.owed = false;
      if (passing.copies < 255) ++passing.copies;  // It may have been another's.
      break;
    }
  }
}

}  // namespace rubric::check
