#include "conformance/check/judge/forward.h"

#include <algorithm>

#include "conformance/check/links.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using machine::Route;

constexpr std::int64_t kStartUs = 5'000'000;  // A buffer may hold older frames until then.
constexpr std::int64_t kIslandSlackUs = 1'000'000;
constexpr std::size_t kTwinsLook = 64;

// On the serial line nbytes and the bytes after the payload may differ (N6-CONTENT).
bool begins_with(const Net& serial, const Net& radio) {
  const std::size_t n = radio.payload.size();
  // The serial payload is whole, even if its nbytes is wrong.
  const Bytes whole(serial.payload.data(), std::max<std::size_t>(serial.payload.size(), 0));
  return whole.size() >= n && equal(whole.first(n), radio.payload);
}

}  // namespace

Forwarding::Forwarding(Context& context) : context_(context) {
  for (std::size_t i = 0; i < context.who.devices.size(); ++i) {
    const Device& device = context.who.devices[i];
    if (device.role != Role::kSink || !device.known) continue;
    Line line;
    line.sink = static_cast<std::uint16_t>(i);
    line.am = device.am;
    line.island = device.island;
    line.serial = device.shows_line();
    line.slack_us = device.whole ? context.response_us() : kIslandSlackUs;
    lines_.push_back(std::move(line));
  }
}

bool Forwarding::Line::changing(std::int64_t time_us) const {
  return std::abs(time_us - island_changed_us) < slack_us;
}

Forwarding::Line* Forwarding::find(std::uint16_t sink) {
  for (Line& line : lines_) {
    if (line.sink == sink) return &line;
  }
  return nullptr;
}

void Forwarding::set_island(std::uint16_t sink, std::uint16_t island, std::int64_t now_us,
                            bool sure) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  if (line->island == island) return;
  // It may pass on as the sink of either island what still waits.
  forget_owed(line->up, line->owed_up);
  forget_owed(line->down, line->owed_down);
  line->island_changed_us = now_us;
  line->island_sure = sure;
  line->last_island = line->island;
  line->island = island;
}

void Forwarding::begin_life(std::uint16_t sink) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->up.clear();
  line->down.clear();
  line->owed_up = line->owed_down = 0;
  line->off = line->deaf = false;
}

void Forwarding::serial_set(std::uint16_t sink, bool on) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->off = !on;
  if (!on) forget_owed(line->up, line->owed_up);
}

void Forwarding::forget_owed(Ring<Passing, kRoom>& ring, std::uint32_t& owed) {
  for (std::size_t i = 0; i < ring.size(); ++i) ring.newest(i).owed = false;
  owed = 0;
}

void Forwarding::radio_set(std::uint16_t sink, bool on) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  line->deaf = !on;
  if (!on) forget_owed(line->down, line->owed_down);
}

void Forwarding::store(Ring<Passing, kRoom>& ring, const Passing& passing, std::uint32_t& owed) {
  if (ring.full() && ring.oldest(0).owed) --owed;
  Passing& stored = ring.push(passing);
  if (passing.owed) ++owed;
  for (std::size_t i = 1; i < std::min(ring.size(), kTwinsLook); ++i) {
    Passing& other = ring.newest(i);
    if (!same_message(other.net, stored.net)) continue;
    other.twin = stored.twin = true;
    return;
  }
}

void Forwarding::heard_on_radio(const Observation& seen, std::uint16_t sender, const Net& net,
                                std::uint16_t surely_received_by) {
  for (Line& line : lines_) {
    if (line.sink == sender || !line.serial || line.island == 0) continue;
    // A sink with a log of what it was given hears nothing else, and hears it in its own order.
    const bool sure = surely_received_by == line.sink;
    if (context_.device(line.sink).hearing ? !sure : seen.received) continue;
    if (seen.frame.dest != line.am && seen.frame.dest != machine::kAmBroadcast) continue;
    const Route route =
        machine::route_received({Role::kSink, {line.island, line.am}, true, context_.sink_am},
                                Link::kRadio, net.dest, net.src);
    Passing passing;
    passing.net = net;
    passing.place = seen.place;
    passing.whole_us = seen.place.time_us + air_us(seen);
    passing.order = ++line.order;
    passing.sender = sender;
    const bool onward = route.onward == Route::Onward::kSerial;
    if (!net.sound) {
      passing.forbidden = "N11-NBYTES"_rule;
    } else if (!onward && !route.deliver && net.dest.pid != machine::kBroadcastPid) {
      passing.forbidden = route.requirement;
      passing.weak = route.requirement == "N6-OTHER"_rule;
    }
    passing.owed = onward && !line.off && !line.deaf && net.sound && net.reliable <= 1 &&
                   net.src.pid == line.island && sure;
    // The message may be on the serial line already, if the two taps' clocks differ.
    bool early = false;
    for (std::size_t i = 0; i < line.early.size(); ++i) {
      Passing& before = line.early.newest(i);
      if (before.passed != 0 || !same_message(before.net, net) || !begins_with(before.net, net)) {
        continue;
      }
      before.passed = 1;
      passing.passed = 1;
      passing.owed = false;
      early = true;
      break;
    }
    store(line.up, passing, line.owed_up);
    if (early && passing.forbidden != ReqId::kNone) pass_up(line, line.up.newest(0), seen);
  }
}

void Forwarding::repeated(const Net& net, std::uint16_t sink) {
  for (Line& line : lines_) {
    if (sink != kNobody && line.sink != sink) continue;
    Ring<Passing, kRoom>& ring = sink == kNobody ? line.up : line.down;
    for (std::size_t i = 0; i < std::min(ring.size(), kTwinsLook); ++i) {
      Passing& passing = ring.newest(i);
      if (!same_message(passing.net, net)) continue;
      if (passing.copies < 255) ++passing.copies;
      passing.twin = true;
      break;
    }
  }
}

void Forwarding::heard_on_serial(std::uint16_t sink, std::uint16_t base, const Observation& seen,
                                 const Net& net, bool surely_received) {
  Line* const line = find(sink);
  if (line == nullptr || line->island == 0) return;
  const Route route =
      machine::route_received({Role::kSink, {line->island, line->am}, true, context_.sink_am},
                              Link::kSerial, net.dest, net.src);
  const bool onward = route.onward == Route::Onward::kRadio;
  Passing passing;
  passing.net = net;
  passing.place = seen.place;
  passing.whole_us = seen.place.time_us + air_us(seen);
  passing.order = ++line->order;
  passing.sender = base;
  passing.am_dest = onward ? route.am_dest : net.dest.devid;
  if (!net.sound) {
    passing.forbidden = "N11-NBYTES"_rule;
  } else if (route.requirement == "N7-FOREIGN"_rule) {
    passing.forbidden = "N7-FOREIGN"_rule;
    passing.weak = true;
  }
  passing.sure = surely_received;
  // A log says what was received.
  passing.owes = onward && net.sound && net.reliable <= 1 && !line->deaf &&
                 net.dest.pid != machine::kBroadcastPid;
  passing.owed = passing.owes && (surely_received || !context_.device(sink).hearing);
  store(line->down, passing, line->owed_down);
  const bool foreign = net.dest.pid != line->island && net.dest.pid != machine::kBroadcastPid;
  if (!foreign) return;
  context_.report("N8-LOOP"_rule, Severity::kWeak, seen.place, base,
                  {"A message to " + text_of(net.dest) + " is handed to the sink of island " +
                       number(line->island) + ".",
                   "Another island's messages go through PEIS.",
                   {}});
}

void Forwarding::surely_down(std::uint16_t sink, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    Passing& passing = line->down.newest(i);
    if (!same_message(passing.net, net)) continue;
    passing.sure = true;
    if (passing.owes && !passing.owed && passing.passed == 0) {
      passing.owed = true;
      ++line->owed_down;
    }
    return;
  }
}

bool Forwarding::out_of_order(const Passing& passing, std::uint64_t& last) {
  const bool late = passing.order < last && !passing.twin;
  last = std::max(last, passing.order);
  return late;
}

void Forwarding::pass_up(Line& line, Passing& passing, const Observation& seen) {
  if (passing.forbidden != ReqId::kNone) {
    if (line.changing(passing.place.time_us)) return;
    Said said;
    const Net& net = passing.net;
    const bool stale = line.last_island != 0 &&
                       (net.dest.pid == line.last_island || net.src.pid == line.last_island);
    if (passing.forbidden == "N6-COLLISION"_rule && stale) passing.forbidden = "N9-SET"_rule;
    if (passing.forbidden == "N11-NBYTES"_rule) {
      said.text = "The sink forwards " + name_of(passing.net) + ", whose nbytes is " +
                  number(passing.net.nbytes) + " while " + number(passing.net.payload.size()) +
                  " bytes came.";
      said.expected = "A malformed message is dropped.";
    } else {
      said.text = "The sink of island " + number(line.island) + " forwards " +
                  name_of(passing.net) + " to its base station.";
      said.expected = "It is ignored: neither its destination nor its source makes it this sink's.";
    }
    const bool format = passing.forbidden == "N11-NBYTES"_rule;
    Severity severity = passing.weak ? Severity::kWeak : Severity::kFail;
    if (!format) severity = context_.on_line(line.sink, severity);  // SET_ISLAND_ID may be missing.
    if (!format && !line.island_sure) severity = std::min(severity, Severity::kInconclusive);
    context_.report(passing.forbidden, severity, seen.place, line.sink, std::move(said));
  } else {
    context_.findings.kept("N6-CONTENT"_rule);
    context_.findings.kept("N6-ONCE"_rule);
    const bool own_island = passing.net.dest.pid == line.island;
    context_.findings.kept(own_island ? "N6-FORWARD"_rule : "N6-ROUTE"_rule);
  }
  if (out_of_order(passing, line.last_up)) {
    context_.report(
        "N2-ORDER"_rule, context_.on_line(line.sink, Severity::kFail), seen.place, line.sink,
        {"The sink forwards " + name_of(passing.net) + " after one that it heard later.",
         "Received messages are handled in the order of arrival.",
         {}});
  }
}

void Forwarding::sent_on_serial(std::uint16_t sink, const Observation& seen, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  const std::int64_t now = seen.place.time_us;
  if (line->early.size() > 0) expire_early(*line, now);
  for (std::size_t i = 0; i < line->up.size(); ++i) {
    Passing& passing = line->up.newest(i);
    if (passing.passed >= passing.copies || !same_message(passing.net, net) ||
        !begins_with(net, passing.net)) {
      continue;
    }
    ++passing.passed;
    if (passing.owed) --line->owed_up;
    passing.owed = false;
    if (net.sound && passing.net.sound && net.nbytes > passing.net.nbytes) {
      line->stale.add(seen.place, passing.net.nbytes, net.nbytes);
    }
    pass_up(*line, passing, seen);
    if (line->owed_up > 0) overdue_up(*line, now);
    return;
  }
  refuse_up(*line, seen, net);
  if (line->owed_up > 0) overdue_up(*line, now);
}

void Forwarding::refuse_up(Line& line, const Observation& seen, const Net& net) {
  for (std::size_t i = 0; i < std::min(line.down.size(), kTwinsLook); ++i) {
    if (!same_message(line.down.newest(i).net, net)) continue;
    context_.report("N6-ONCE"_rule, Severity::kFail, seen.place, line.sink,
                    {"The sink hands " + name_of(net) + " back to its base station.",
                     "What comes over serial does not go back over serial.",
                     {}});
    return;
  }
  if (!(context_.hears_radio || context_.device(line.sink).whole) || line.island == 0) return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.newest(i);
    if (passing.net.seq_num != net.seq_num || passing.net.src != net.src) continue;
    const bool same = same_message(passing.net, net) && begins_with(net, passing.net);
    Said said;
    if (same) {
      said.text = "The sink forwards " + name_of(net) + " again.";
      said.expected = "Once for each time that it was received.";
      context_.report("N6-ONCE"_rule,
                      context_.without(passing.sender, passing.place.time_us, seen.place.time_us),
                      seen.place, line.sink, std::move(said));
      return;
    }
    said.text = "The sink forwards " + name_of(net) + ", reliable " + number(net.reliable) +
                ", with another content than it was heard with: to " + text_of(passing.net.dest) +
                ", reliable " + number(passing.net.reliable) + ", " + number(passing.net.nbytes) +
                " bytes.";
    said.expected = "Addresses, reliable, number and payload as they were heard.";
    const bool other = passing.passed > 0;  // Then this may be another message, not captured.
    context_.report(
        "N6-CONTENT"_rule,
        other || passing.net.dest != net.dest
            ? context_.without(passing.sender, passing.place.time_us, seen.place.time_us)
            : Severity::kFail,
        seen.place, line.sink, std::move(said));
    passing.passed = std::max<std::uint8_t>(passing.passed, 1);
    if (passing.owed) --line.owed_up;
    passing.owed = false;
    return;
  }
  Passing early;
  early.net = net;
  early.place = seen.place;
  if (line.early.full() && line.early.oldest(0).passed == 0) unheard(line, line.early.oldest(0));
  line.early.push(early);
}

// Reports serial frames for which no radio frame came, not even within the skew of the taps.
void Forwarding::expire_early(Line& line, std::int64_t now_us) {
  for (std::size_t i = 0; i < line.early.size(); ++i) {
    Passing& early = line.early.oldest(i);
    if (early.passed != 0 || now_us - early.place.time_us <= context_.options.skew_us) continue;
    early.passed = 1;
    unheard(line, early);
  }
}

void Forwarding::unheard(Line& line, const Passing& early) {
  const bool began =
      context_.options.start_cold || early.place.time_us - context_.run.start_us > kStartUs;
  const bool complete = context_.options.sniffer_complete && began;
  context_.report(
      "N6-ONCE"_rule, complete ? Severity::kFail : Severity::kInconclusive, early.place, line.sink,
      {"The sink puts " + name_of(early.net) + " on its serial line; nobody was heard sending it.",
       "A message that a mote sent.",
       {}});
}

void Forwarding::finish(std::int64_t end_us) {
  for (Line& line : lines_) {
    // At its end a log of what the sink was given needs no sign of life.
    if (context_.device(line.sink).hearing && line.owed_up > 0) overdue_up(line, end_us);
    if (context_.device(line.sink).hearing && line.owed_down > 0) overdue_down(line, end_us);
    expire_early(line, end_us + context_.options.skew_us + 1);
    note_stale(context_, line.sink, "N6-CONTENT"_rule, line.stale,
               "On the serial line nbytes says ");
  }
}

}  // namespace rubric::check
