#include "conformance/check/input/directions.h"

#include <map>
#include <optional>
#include <utility>

#include "conformance/check/message.h"

namespace rubric::check {
namespace {

// Returns whether the frame is one towards the sink, if its kind or its message shows it.
std::optional<bool> shown_by(const Observation& seen) {
  if (seen.kind == Observation::Kind::kLinkAck) return false;
  if (seen.frame.type == am::kConfig) return true;
  Net net;
  const bool up = seen.frame.type == am::kNet && parse_net(seen.frame.payload, net) &&
                  net.src.devid != machine::kNullDevid &&
                  net.dest == machine::Address{net.src.pid, machine::kNullDevid};
  if (seen.ack_request) return up ? std::nullopt : std::optional(true);
  return up ? std::optional(false) : std::nullopt;
}

// Tells frames down lines that say nothing of directions, and have no numbers, by their messages:
// what another island sends to that of the line was handed down.
void find_handed_down(Run& run) {
  const auto silent = [&](const Observation& seen) {
    const Tap& tap = run.taps[seen.tap];
    return seen.node.empty() && seen.kind == Observation::Kind::kSerial &&
           seen.frame.type == am::kNet && !tap.has_direction && !tap.numbered;
  };
  std::map<std::pair<std::uint32_t, std::uint16_t>, std::size_t> up;  // By tap and island.
  Net net;
  for (const Observation& seen : run.seen) {
    if (silent(seen) && shown_by(seen) == false && parse_net(seen.frame.payload, net)) {
      ++up[{seen.tap, net.dest.pid}];
    }
  }
  for (Observation& seen : run.seen) {
    if (!silent(seen) || shown_by(seen) || !parse_net(seen.frame.payload, net)) continue;
    const auto count = [&](std::uint16_t island) {
      const auto found = up.find({seen.tap, island});
      return found == up.end() ? 0 : found->second;
    };
    if (count(net.dest.pid) > count(net.src.pid)) seen.to_mote = true;
  }
}

}  // namespace

void count_direction(const Observation& seen, bool stated, Tap& tap) {
  if (seen.kind == Observation::Kind::kSerial && seen.ack_request) tap.numbered = true;
  if (!stated) return;
  const std::optional<bool> shown = shown_by(seen);
  if (shown) tap.contradicted += *shown == seen.to_mote ? -1 : 1;
}

void find_directions(Run& run) {
  for (Observation& seen : run.seen) {
    const Tap& tap = run.taps[seen.tap];
    if (!seen.node.empty() || tap.link != machine::Link::kSerial) continue;
    if (tap.has_direction) {
      seen.to_mote = seen.to_mote != (tap.contradicted > 0);
    } else if (tap.numbered && seen.kind == Observation::Kind::kSerial) {
      seen.to_mote = seen.ack_request || seen.frame.type == am::kConfig;
    }
  }
  find_handed_down(run);
  for (const Tap& tap : run.taps) {
    if (!tap.has_direction || tap.contradicted <= 0) continue;
    run.facts.push_back(tap.name +
                        ": its directions are those of the capturing host, by the kinds of its "
                        "frames; they are turned");
  }
}

bool looks_towards_sink(const machine::Frame& frame) {
  if (frame.type == am::kConfig) return true;
  Net net;
  return frame.type == am::kNet && parse_net(frame.payload, net) &&
         net.src.devid == machine::kNullDevid && net.dest.devid != machine::kNullDevid;
}

}  // namespace rubric::check
