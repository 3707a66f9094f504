#include "conformance/check/identify/line_losses.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "conformance/check/message.h"

namespace rubric::check {
namespace {

constexpr std::size_t kNumbersMin = 48;    // Of a line; a fifth of all frames shows by then,
constexpr std::size_t kNumbersMissed = 8;  // and less when so many of them must be missing.
constexpr std::size_t kHoleShare = 50;     // Frames of the air for each hole among them.
// No parameter says how long a host waits for a confirmation; those of TinyOS wait 1 s
// (ACK_TIMEOUT of Packetizer.java and serialsource.c). Stamps of frames on the line may be less
// apart.
constexpr std::int64_t kHostWaitsUs = 950'000;
// Few holes may be a few less than there are as a rule, and a line may lose as much more.
constexpr std::size_t kHolesMore = 3;
constexpr std::size_t kLossMore = 3;
constexpr std::size_t kCopiesMore = 2;  // The link may make more copies than were captured.

// What a capture misses of the air.
struct MissedOfAir {
  std::size_t holes = 0;
  std::size_t frames = 0;
  bool many = false;
};

MissedOfAir missed_of_air(const Identity& who, const Options& options) {
  MissedOfAir out;
  for (const Device& device : who.devices) {
    out.holes += device.holes.size();
    out.frames += device.frames;
  }
  if (options.sniffer_complete) out.holes = 0;
  out.many = !options.sniffer_complete && kHoleShare * out.holes >= out.frames;
  return out;
}

// Returns how many copies of requests and replies may be missing: as many as those that are there
// and the share of frames that are not make likely, and none where all are there.
std::size_t missed_copies(const Run& run, const Identity& who, const MissedOfAir& air) {
  if (air.holes == 0 || air.frames == 0) return 0;
  std::size_t copies = kCopiesMore;
  for (std::size_t i = run.past.senders.size(); i < run.seen.size(); ++i) {
    const std::uint8_t type = run.seen[i].frame.type;
    const bool copy = run.seen[i].kind == Observation::Kind::kRadio && who.marks[i].repeat;
    copies += copy && (type == am::kJoin || type == am::kJoinReply) ? 1 : 0;
  }
  return 1 + kLossMore * copies * (air.holes + kHolesMore) / air.frames;
}

}  // namespace

// Hosts number their packets, and send the next one when the mote has confirmed the last. A line
// with few such numbers is no better than the capture of the air, whose frames are all numbered;
// alone it proves nothing.
Losses find_losses(const Run& run, const Identity& who, const Options& options) {
  struct Line {
    const Observation* last = nullptr;
    bool confirmed = false;
    std::uint8_t damaged = 0;  // Frames since then; each may have been a packet or its ack.
    std::size_t numbers = 0;   // That followed, or confirmed.
    std::size_t frames = 0;
  };
  std::vector<Line> lines(run.taps.size());
  std::vector<LineLoss> out(run.taps.size());
  for (std::size_t i = run.past.senders.size(); i < run.seen.size(); ++i) {
    const Observation& seen = run.seen[i];
    if (!seen.node.empty() || run.taps[seen.tap].link != machine::Link::kSerial) continue;
    Line& line = lines[seen.tap];
    bool& any = out[seen.tap].any;
    const bool first = line.frames++ == 0;
    if (seen.kind == Observation::Kind::kDamaged) {
      if (line.damaged < 127) ++line.damaged;
    } else if (seen.kind == Observation::Kind::kLinkAck && !seen.to_mote && line.last == nullptr) {
      any = any || (!first && line.damaged == 0);  // Its packet is missing.
    } else if (seen.kind == Observation::Kind::kLinkAck && !seen.to_mote) {
      const auto ahead = static_cast<std::int8_t>(seen.dsn - line.last->dsn);
      line.confirmed = line.confirmed || ahead == 0;
      ++line.numbers;
      if (ahead > line.damaged) any = true;
    } else if (seen.kind == Observation::Kind::kSerial && seen.to_mote && seen.ack_request) {
      if (line.last != nullptr) {
        const auto ahead = static_cast<std::uint8_t>(seen.dsn - line.last->dsn);
        const bool soon =
            !seen.place.timed() || seen.place.time_us - line.last->place.time_us < kHostWaitsUs;
        const bool unconfirmed = !line.confirmed && line.damaged == 0 && soon;
        if (ahead > 1 + line.damaged || unconfirmed) any = true;
      }
      line = {&seen, false, 0, line.numbers + 1, line.frames};
    }
  }
  const MissedOfAir air = missed_of_air(who, options);
  for (std::size_t tap = 0; tap < lines.size(); ++tap) {
    const Line& line = lines[tap];
    const bool few =
        line.numbers < kNumbersMin || line.numbers * air.holes < kNumbersMissed * air.frames;
    if (line.frames == 0 || !few) continue;
    if (air.many) {
      out[tap].any = true;
    } else if (air.holes > 0) {
      out[tap].most = 1 + kLossMore * (air.holes + kHolesMore) * line.frames / air.frames;
    }
  }
  for (std::size_t tap = 0; tap < run.past.lossy_taps.size(); ++tap) {
    if (run.past.lossy_taps[tap]) out[tap].any = true;
  }
  return {std::move(out), air.many, missed_copies(run, who, air)};
}

bool misses_passed(const Run& run, const Identity& who, std::uint16_t sink) {
  const Device& its = who.devices[sink];
  std::set<std::pair<std::uint64_t, std::uint16_t>> air;
  std::set<std::pair<std::uint64_t, std::uint16_t>> line;
  const auto of_line = [&](const Observation& seen) {
    return std::ranges::find(its.taps, seen.tap) != its.taps.end();
  };
  const auto first = std::ranges::find_if(run.seen, of_line);
  const auto end = std::find_if(run.seen.rbegin(), run.seen.rend(), of_line).base();
  for (auto at = first; at < end; ++at) {
    Net net;
    if (at->frame.type != am::kNet || !parse_net(at->frame.payload, net) || !net.sound) continue;
    if (of_line(*at)) {
      line.emplace(net.addresses(), net.seq_num);
      continue;
    }
    const bool sent = who.marks[static_cast<std::size_t>(at - run.seen.begin())].device == sink;
    const bool down = sent && net.src.devid == machine::kNullDevid;
    const bool up = !sent && at->frame.dest == its.am && net.src.pid == its.island &&
                    (net.dest.pid != its.island || net.dest.devid == machine::kNullDevid);
    if (at->kind == Observation::Kind::kRadio && (down || up)) {
      air.emplace(net.addresses(), net.seq_num);
    }
  }
  const auto missed = static_cast<std::size_t>(
      std::ranges::count_if(air, [&](const auto& one) { return !line.contains(one); }));
  return missed > 0 && kHoleShare * missed >= air.size();
}

}  // namespace rubric::check
