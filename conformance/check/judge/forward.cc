#include "conformance/check/judge/forward.h"

#include <algorithm>

#include "conformance/check/links.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using machine::Route;

constexpr std::uint32_t kSilent = 3;  // That none of so many messages is forwarded is no chance.
constexpr std::int64_t kStartUs = 5'000'000;  // A buffer may hold older frames until then.

// On the serial line nbytes and the bytes after the payload may differ (N6-CONTENT).
bool begins_with(const Net& serial, const Net& radio) {
  const std::size_t n = radio.payload.size();
  return serial.payload.size() >= n && equal(serial.payload.first(n), radio.payload);
}

}  // namespace

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
    line.heard += onward && net.sound && net.src.pid == line.island ? 1 : 0;
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
  } else if (net.dest == machine::Address{line->island, line->am}) {
    passing.forbidden = "N7-DELIVER"_rule;
  }
  passing.sure = surely_received;
  passing.cut =
      context_.device(sink).whole && seen.frame.payload.size() < rubicon::NetMsgView::kMaxSizeBytes;
  // A log says what was received.
  passing.owes = onward && net.sound && net.reliable <= 1 && !line->deaf &&
                 net.dest.pid != machine::kBroadcastPid;
  passing.owed = passing.owes && (surely_received || !context_.device(sink).hearing);
  store(line->down, passing, line->owed_down);
  // A capture does not show whether the base station wrote it; from PEIS come other islands' only.
  const bool own_island = net.src.pid == line->island && net.src.devid != machine::kNullDevid;
  if (own_island && net.sound && !context_.device(base).hearing && !holds(line->up, net, false)) {
    context_.report("N1-SRC"_rule, Severity::kWeak, seen.place, base,
                    {"A message from " + text_of(net.src) + " is handed to the sink of island " +
                         number(line->island) + ".",
                     "Messages of the base station, or of other islands.",
                     {}});
  }
  const bool foreign = net.dest.pid != line->island && !machine::is_reserved(net.dest.pid);
  if (!foreign) return;
  context_.report("N8-LOOP"_rule, Severity::kWeak, seen.place, base,
                  {"A message to " + text_of(net.dest) + " is handed to the sink of island " +
                       number(line->island) + ".",
                   "Another island's messages go through PEIS.",
                   {}});
}

void Forwarding::judge_order(Line& line, const Passing& passing, const Observation& seen) {
  const bool up = seen.frame.link == Link::kSerial;
  Line::Last& last = up ? line.last_up : line.last_down;
  const bool log = context_.device(line.sink).hearing;
  // Frames that overlap on the air have no order. Of two messages that are alike nobody knows which
  // one was passed on.
  const bool unclear = passing.twin || (up && !log && passing.whole_us > last.begun_us);
  if (passing.order > last.order && !passing.twin) last = {passing.order, passing.place.time_us};
  if (passing.order < last.order && !unclear) {
    context_.report("N2-ORDER"_rule, context_.on_line(line.sink, Severity::kFail), seen.place,
                    line.sink,
                    {std::string("The sink ") + (up ? "forwards " : "radiates ") +
                         name_of(passing.net) + " after one that came later.",
                     "Messages leave in the order in which they came.",
                     {}});
  } else if (!passing.twin && passing.copies == 1) {
    context_.left(line.sink, seen.frame.link, seen.place, passing.whole_us,
                  context_.handled_us(line.sink, passing.whole_us, seen.place.time_us),
                  name_of(passing.net));
  }
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
    ++line.forwarded;
    context_.findings.kept("N6-CONTENT"_rule);
    context_.findings.kept("N6-ONCE"_rule);
    const bool own_island = passing.net.dest.pid == line.island;
    context_.findings.kept(own_island ? "N6-FORWARD"_rule : "N6-ROUTE"_rule);
  }
  judge_order(line, passing, seen);
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
    if (!net.sound && passing.net.sound) {
      report_nbytes(context_, line->sink, seen.place, net);
    } else if (passing.net.sound && net.nbytes > passing.net.nbytes) {
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
  if (!(context_.who.sees_air || context_.device(line.sink).whole) || line.island == 0) return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.newest(i);
    if (passing.net.seq_num != net.seq_num || passing.net.src != net.src) continue;
    const bool same = same_message(passing.net, net) && begins_with(net, passing.net);
    Said said;
    if (same) {
      said.text = "The sink forwards " + name_of(net) + " again.";
      said.expected = "Once for each time that it was received.";
      context_.report("N6-ONCE"_rule,
                      context_.without_copy(passing.sender, passing.place, seen.place.time_us),
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
  Passing* meant = nullptr;  // It came and waits; this one may have been made from it.
  for (std::size_t i = 0; i < line.up.size() && meant == nullptr; ++i) {
    Passing& passing = line.up.oldest(i);
    const bool alike =
        passing.net.dest == early.net.dest && begins_with(early.net, passing.net) &&
        (passing.net.src == early.net.src || passing.net.seq_num == early.net.seq_num);
    const bool waits = passing.passed == 0 && passing.forbidden == ReqId::kNone &&
                       passing.place.time_us <= early.place.time_us;
    if (waits && alike) meant = &passing;
  }
  const bool began =
      context_.options.start_cold || early.place.time_us - context_.run.start_us > kStartUs;
  const bool complete = context_.options.sniffer_complete && began;
  const Severity severity = complete ? Severity::kFail : Severity::kInconclusive;
  if (meant != nullptr && complete) {
    if (meant->owed) --line.owed_up;
    meant->owed = false;
    meant->passed = 1;
    context_.report("N6-CONTENT"_rule, severity, early.place, line.sink,
                    {"The sink forwards " + name_of(early.net) + "; what it received was " +
                         name_of(meant->net) + ".",
                     "Addresses, reliable, number and payload as they were heard.",
                     {}});
    return;
  }
  context_.report(
      "N6-ONCE"_rule, severity, early.place, line.sink,
      {"The sink puts " + name_of(early.net) + " on its serial line; nobody was heard sending it.",
       "A message that a mote sent.",
       {}});
}

void Forwarding::pass_down(Line& line, Passing& passing, const Observation& seen, const Net& net) {
  if (passing.forbidden != ReqId::kNone) {
    const bool malformed = passing.forbidden == "N11-NBYTES"_rule;
    context_.report(
        passing.forbidden, passing.weak ? Severity::kWeak : Severity::kFail, seen.place, line.sink,
        {"The sink of island " + number(line.island) + " radiates " + name_of(net) +
             (malformed ? ", whose nbytes is " + number(passing.net.nbytes) + " while " +
                              number(passing.net.payload.size()) + " bytes came."
                        : "."),
         malformed      ? "A malformed message is dropped."
         : passing.weak ? "Another island's messages are not radiated."
                        : "It is for the sink itself, whose application gets it.",
         {}});
  } else if (seen.frame.dest != passing.am_dest) {
    context_.report(
        "N7-RADIO"_rule, Severity::kFail, seen.place, line.sink,
        {"The sink radiates " + name_of(net) + " to AM address " + number(seen.frame.dest) + ".",
         "AM address " + number(passing.am_dest) + ".",
         {}});
  } else if (seen.frame.payload.size() > kNetHeaderBytes + net.payload.size()) {
    context_.report("N7-CONTENT"_rule, Severity::kFail, seen.place, line.sink,
                    {"The sink radiates " + name_of(net) + " with " +
                         number(seen.frame.payload.size() - kNetHeaderBytes - net.payload.size()) +
                         " bytes after its payload.",
                     "No byte after the payload.",
                     {}});
  } else {
    context_.findings.kept("N7-RADIO"_rule);
    context_.findings.kept("N7-CONTENT"_rule);
  }
  judge_order(line, passing, seen);
}

bool Forwarding::sent_on_radio(std::uint16_t sink, const Observation& seen, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr || !line->serial) return false;
  Passing* near = nullptr;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    Passing& passing = line->down.newest(i);
    if (!same_message(passing.net, net)) {
      const bool close = resembles(*line, passing, net);
      if (close && near == nullptr) near = &passing;
      continue;
    }
    if (near == nullptr || same_payload(passing.net, net)) near = &passing;
    if (passing.passed >= passing.copies || !same_payload(passing.net, net)) continue;
    ++passing.passed;
    if (passing.owed) --line->owed_down;
    passing.owed = false;
    pass_down(*line, passing, seen, net);
    return true;
  }
  if (may_be_anothers(*line, net) || relayed(*line, seen, net)) return true;
  if (near != nullptr) {
    refuse_down(*line, seen, net);
    return true;
  }
  // Only a complete run, in its order, shows that nobody gave the sink this message.
  const std::int64_t now = seen.place.time_us;
  const bool sure = !context_.run.order_guessed &&
                    context_.without_ever(kNobody, now) == Severity::kFail &&
                    context_.on_line(sink, Severity::kFail) == Severity::kFail;
  const bool held = context_.busy(sink, line->island_changed_us, now);
  if (!sure || held || line->changing(now)) return true;
  if (context_.half_heard(sink)) {
    context_.needs_host(sink, seen.place);
    return true;
  }
  // All sinks have one AM address, so this may be the own message of another one.
  const bool anothers = std::ranges::any_of(lines_, [&](const Line& other) {
    return other.sink != sink && net.src == machine::Address{other.island, other.am};
  });
  const bool open = anothers && !context_.device(sink).hearing;
  context_.report("N7-CONTENT"_rule, open ? Severity::kInconclusive : Severity::kFail, seen.place,
                  sink,
                  {"The sink radiates " + name_of(net) + "; nobody sent it this.",
                   "Its own messages, and those that came to it.",
                   {}});
  return true;
}

// Judges what the sink sends on by radio that it heard there. Returns whether it is such a message.
bool Forwarding::relayed(Line& line, const Observation& seen, const Net& net) {
  const bool mote = net.dest.pid == line.island && net.dest.devid != line.am &&
                    !machine::is_reserved(net.dest.devid);
  Passing* heard = nullptr;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.newest(i);
    if (!same_message(passing.net, net) || !same_payload(passing.net, net)) continue;
    heard = &passing;
    if (passing.relayed < passing.copies) break;
  }
  if (heard == nullptr) return false;
  // Once it may what is for a mote of its island, to it (decision 115), or for all (decision 114).
  const bool again = heard->relayed >= heard->copies;
  const bool forbidden = heard->forbidden != ReqId::kNone && (!mote || !net.sound);
  const bool right = mote && !again && !forbidden && seen.frame.dest == net.dest.devid;
  if (heard->relayed < 255) ++heard->relayed;
  const bool all = net.dest.pid == machine::kBroadcastPid && net.sound && heard->passed == 0;
  if (right || (all && !again)) return true;
  const Severity severity = forbidden && heard->weak ? Severity::kWeak : Severity::kFail;
  context_.report(
      forbidden        ? heard->forbidden
      : mote && !again ? "N4-MOTE"_rule
                       : "N6-ONCE"_rule,
      context_.on_line(line.sink,
                       line.changing(seen.place.time_us) ? Severity::kInconclusive : severity),
      seen.place, line.sink,
      {"The sink sends on by radio " + name_of(net) +
           (again ? " again." : ", which came by radio."),
       mote ? "Nothing, or once to AM address " + number(net.dest.devid) + "."
            : "Nothing by radio.",
       {}});
  return true;
}

void Forwarding::overdue(std::uint16_t sink, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  if (line->early.size() > 0) expire_early(*line, now_us);  // It may be what is missing.
  if (line->owed_up > 0) overdue_up(*line, now_us);
  if (line->owed_down > 0) overdue_down(*line, now_us);
}

void Forwarding::showed_life(std::uint16_t sink, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line != nullptr && line->owed_down > 0) overdue_down(*line, now_us);
}

// Returns whether a message was made of one that came: it has its source and number, or, while that
// one waits, the number and all but the source; by a log of the sink also all but the number.
bool Forwarding::resembles(const Line& line, const Passing& came, const Net& net) const {
  const bool source = came.net.src == net.src;
  const bool numbered = came.net.seq_num == net.seq_num;
  if (source && numbered) return true;
  return came.owed && (numbered || (source && context_.device(line.sink).hearing)) &&
         came.net.dest == net.dest && equal(came.net.payload, net.payload);
}

bool Forwarding::alters(std::uint16_t sink, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr) return false;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    const Passing& passing = line->down.newest(i);
    if (passing.owed && passing.net.src != net.src && resembles(*line, passing, net)) return true;
  }
  return false;
}

bool Forwarding::alters_up(std::uint16_t sink, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr) return false;
  for (std::size_t i = 0; i < line->up.size(); ++i) {
    const Passing& passing = line->up.newest(i);
    const bool waits = passing.passed == 0 && passing.forbidden == ReqId::kNone;
    if (waits && passing.net.dest == net.dest && passing.net.seq_num == net.seq_num &&
        passing.net.src != net.src && begins_with(net, passing.net)) {
      return true;
    }
  }
  return false;
}

void Forwarding::went_up(std::uint16_t sink, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line != nullptr && line->owed_up > 0) overdue_up(*line, now_us);
}

bool Forwarding::came_up(std::uint16_t sink, const Net& net) {
  const Line* const line = find(sink);
  return line != nullptr && holds(line->up, net, true);
}

bool Forwarding::came_down(std::uint16_t sink, const Net& net) {
  return std::ranges::any_of(lines_, [&](const Line& line) {
    const bool may = line.sink == sink || !context_.device(sink).hearing;
    return may && holds(line.down, net, true);
  });
}

// Returns whether another sink has that message to send: a capture of two sinks with one address
// does not show which of them sent a frame.
bool Forwarding::may_be_anothers(const Line& line, const Net& net) {
  for (Line& other : lines_) {
    if (&other == &line || context_.device(line.sink).hearing) continue;
    for (std::size_t i = 0; i < other.down.size(); ++i) {
      Passing& passing = other.down.newest(i);
      if (passing.passed >= passing.copies || !same_message(passing.net, net)) continue;
      ++passing.passed;
      if (passing.owed) --other.owed_down;
      passing.owed = false;
      return true;
    }
  }
  return false;
}

// Returns whether a buffer may have been full (decision 122): so many messages came around that
// time, or a line was busy.
bool Forwarding::crowded(const Line& line, const Passing& passing, Link out) const {
  const std::int64_t from_us = passing.place.time_us;
  return context_.busy(line.sink, from_us, passing.whole_us + context_.response_us(), out) ||
         context_.crowded(line.sink, from_us);
}

void Forwarding::refuse_down(Line& line, const Observation& seen, const Net& net) {
  Passing* best = nullptr;
  for (std::size_t i = 0; i < line.down.size(); ++i) {
    Passing& passing = line.down.newest(i);
    if (!resembles(line, passing, net)) continue;
    if (best == nullptr || best->passed > 0) best = &passing;
  }
  Said said;
  if (same_message(best->net, net) && same_payload(best->net, net)) {
    said.text = "The sink radiates " + name_of(net) + " again.";
    said.expected = "Once for each time that it came over serial.";
    context_.report("N2-ONCE"_rule, context_.on_line(line.sink, Severity::kFail), seen.place,
                    line.sink, std::move(said));
    return;
  }
  said.text = "The sink radiates " + name_of(net) + ", reliable " + number(net.reliable) +
              ", nbytes " + number(net.nbytes) +
              ", with another content than came over serial: to " + text_of(best->net.dest) +
              ", reliable " + number(best->net.reliable) + ", nbytes " + number(best->net.nbytes) +
              ".";
  said.expected = "Addresses, reliable, number, nbytes and payload as they came.";
  context_.report("N7-CONTENT"_rule, context_.on_line(line.sink, Severity::kFail), seen.place,
                  line.sink, std::move(said));
  if (best->owed) --line.owed_down;
  best->owed = false;
  if (best->passed < 255) ++best->passed;
}

// Reports what was surely received and is missing though the sink has shown life long after.
void Forwarding::overdue_up(Line& line, std::int64_t now_us) {
  if (now_us < 0) return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.oldest(i);
    const std::int64_t due_us = context_.due_us(line.sink, passing.whole_us, Link::kSerial);
    if (!passing.owed || now_us <= due_us) continue;
    passing.owed = false;
    --line.owed_up;
    const bool own_island = passing.net.dest.pid == line.island;
    context_.report(
        own_island ? "N6-FORWARD"_rule : "N6-ROUTE"_rule,
        crowded(line, passing, Link::kSerial) || context_.who.damaged(passing.place.time_us, now_us)
            ? Severity::kInconclusive
            : context_.on_line(line.sink, Severity::kFail),
        passing.place, line.sink,
        {"The sink received " + name_of(passing.net) + " (" +
             (context_.device(line.sink).hearing ? "by its log" : "the link acknowledged it") +
             ") and did not put it on its serial line, though more came later.",
         "A forward within " + ms_text(context_.response_us()) + ".",
         {}});
  }
}

void Forwarding::overdue_down(Line& line, std::int64_t now_us) {
  if (now_us < 0) return;
  for (std::size_t i = 0; i < line.down.size(); ++i) {
    Passing& passing = line.down.oldest(i);
    const std::int64_t due_us = context_.due_us(line.sink, passing.whole_us, Link::kRadio);
    if (!passing.owed || now_us <= due_us) continue;
    passing.owed = false;
    --line.owed_down;
    const bool elsewhere = std::ranges::any_of(lines_, [&](const Line& other) {
      return &other != &line && holds(other.down, passing.net, false);  // It may have radiated it.
    });
    const bool open = !passing.sure || elsewhere || crowded(line, passing, Link::kRadio);
    const Severity severity =
        open ? Severity::kInconclusive : context_.without(line.sink, passing.place.time_us, now_us);
    const Severity its = context_.on_line(line.sink, severity);
    context_.report(passing.cut ? "N11-SHORT"_rule : "N7-RADIO"_rule,
                    passing.cut && its == Severity::kFail ? Severity::kWeak : its, passing.place,
                    line.sink,
                    {(passing.sure ? "The sink confirmed " : "Nothing proves that the sink took ") +
                         name_of(passing.net) +
                         " on its serial line and did not radiate it, though it sent other frames "
                         "later.",
                     "A radio frame to " + number(passing.am_dest) + " within " +
                         ms_text(context_.response_us()) + ".",
                     {}});
  }
}

// Says that of many messages not one left on the line: nothing proves that any of them arrived.
void Forwarding::forwards_nothing(const Line& line) {
  const Passing& last = line.up.newest(0);
  context_.report(
      "N6-FORWARD"_rule, Severity::kInconclusive, last.place, line.sink,
      {"Of the messages to its base station the sink has forwarded none, " + number(line.heard) +
           " up to " + name_of(last.net) + "; nothing proves that one arrived.",
       "Forwards of those that arrived.",
       {}});
}

void Forwarding::finish(std::int64_t end_us) {
  for (Line& line : lines_) {
    // At its end a log of what the sink was given needs no sign of life.
    expire_early(line, end_us + context_.options.skew_us + 1);
    if (context_.device(line.sink).hearing && line.owed_up > 0) overdue_up(line, end_us);
    if (context_.device(line.sink).hearing && line.owed_down > 0) overdue_down(line, end_us);
    const bool silent = line.forwarded == 0 && line.heard >= kSilent;
    if (line.serial && silent && line.up.size() > 0) forwards_nothing(line);
    note_stale(context_, line.sink, "N6-CONTENT"_rule, line.stale,
               "On the serial line nbytes says ");
  }
}

}  // namespace rubric::check
