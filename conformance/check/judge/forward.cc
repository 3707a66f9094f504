// What a sink radiates that came down its serial line; forward_up.cc has the other way.
#include "conformance/check/judge/forward.h"

#include <algorithm>

#include "conformance/check/links.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using machine::Route;

}  // namespace

void Forwarding::heard_on_serial(std::uint16_t sink, std::uint16_t base, const Observation& seen,
                                 const Net& net, Down down) {
  Line* const line = find(sink);
  if (line == nullptr || line->island == kNoIsland) return;
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
  if (down.off) passing.forbidden = "N10-OFF"_rule;
  passing.sure = down.sure;
  passing.came = down.given || down.off || !context_.device(sink).whole;
  passing.cut =
      context_.device(sink).whole && seen.frame.payload.size() < rubicon::NetMsgView::kMaxSizeBytes;
  // A log says what was received.
  passing.owes = onward && net.sound && net.reliable <= 1 && !line->deaf &&
                 net.dest.pid != machine::kBroadcastPid;
  passing.owed = passing.owes && !down.off && (down.sure || !context_.device(sink).hearing);
  // The sink may have radiated it already, if the two taps' clocks differ.
  for (std::size_t i = 0; i < line->ahead.size(); ++i) {
    Passing& ahead = line->ahead.oldest(i);
    const bool soon = seen.place.time_us - ahead.place.time_us <= context_.options.skew_us;
    if (ahead.passed != 0 || !soon || !same_message(ahead.net, net) ||
        !same_payload(ahead.net, net)) {
      continue;
    }
    ahead.passed = passing.passed = 1;
    passing.owed = false;
    break;
  }
  store(line->down, passing);
  // A capture does not show whether the base station wrote it; from PEIS come other islands' only.
  const bool own_island = net.src.pid == line->island && net.src.devid != machine::kNullDevid;
  if (own_island && net.sound && !context_.device(base).hearing && !holds(line->up, net, false)) {
    context_.report("N1-SRC"_rule, Severity::kWeak, seen.place, base,
                    {"A message from " + text_of(net.src) + " is handed to the sink of island " +
                         number(line->island) + ".",
                     "Messages of the base station, or of other islands.",
                     {}});
  }
  const bool foreign = net.dest.pid != line->island && net.dest.pid != down.island &&
                       !machine::is_reserved(net.dest.pid);
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
    Severity severity = context_.on_line(line.sink, Severity::kFail);
    // The one that left before may have come before, too.
    if (context_.after_begin(last.begun_us)) severity = std::min(severity, Severity::kInconclusive);
    // A message that came long ago may have been lost. Then a later copy of it, which the run does
    // not show, is what leaves here.
    const std::int64_t since_us = seen.place.time_us - context_.response_us(line.sink);
    if (!log && passing.last_us < since_us) {
      if (up) {
        severity =
            std::min(severity, context_.without(passing.sender, since_us, seen.place.time_us));
      }
      if (context_.comes(line.sink, seen, passing.net.src, passing.net.seq_num)) {
        severity = std::min(severity, Severity::kInconclusive);
      }
    }
    context_.report("N2-ORDER"_rule, severity, seen.place, line.sink,
                    {std::string("The sink ") + (up ? "forwards " : "radiates ") +
                         name_of(passing.net) + " after one that came later.",
                     "Messages leave in the order in which they came.",
                     {}});
  } else if (log && !passing.twin && passing.copies == 1) {
    context_.left(line.sink, seen.frame.link, seen.place, passing.whole_us,
                  context_.handled_us(line.sink, passing.whole_us, seen.place.time_us),
                  name_of(passing.net));
  }
}

void Forwarding::pass_down(Line& line, Passing& passing, const Observation& seen, const Net& net) {
  if (passing.forbidden != ReqId::kNone) {
    const bool malformed = passing.forbidden == "N11-NBYTES"_rule;
    const bool off = passing.forbidden == "N10-OFF"_rule;
    context_.report(
        passing.forbidden, passing.weak ? Severity::kWeak : Severity::kFail, seen.place, line.sink,
        {"The sink of island " + number(line.island) + " radiates " + name_of(net) +
             (malformed ? ", whose nbytes is " + number(passing.net.nbytes) + " while " +
                              number(passing.net.payload.size()) + " bytes came."
              : off ? ", which came while its serial interface was off."
                    : "."),
         malformed      ? "A malformed message is dropped."
         : off          ? "What is switched off receives nothing."
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
    if (!passing.came) continue;
    if (!same_message(passing.net, net)) {
      const bool close = resembles(*line, passing, net);
      if (close && near == nullptr) near = &passing;
      continue;
    }
    if (near == nullptr || same_payload(passing.net, net)) near = &passing;
    if (passing.passed >= passing.copies || !same_payload(passing.net, net)) continue;
    ++passing.passed;
    if (passing.owed) --line->down.owed;
    passing.owed = false;
    pass_down(*line, passing, seen, net);
    return true;
  }
  // Of what shows another island plainly, only its DSN can have told that this sink sent it.
  const bool plain = net.src.pid == net.dest.pid && net.src.pid != line->island &&
                     !line->changing(seen.place.time_us);
  // It may come down the line soon, if the two taps' clocks differ.
  const bool soon = context_.comes(sink, seen, net.src, net.seq_num);
  if (!soon && ((!plain && may_be_anothers(*line, net)) || relayed(*line, seen, net))) return true;
  if (line->down.forgotten > 0) {
    --line->down.forgotten;
    return true;
  }
  if (near != nullptr && !soon) {
    refuse_down(*line, seen, net);
    return true;
  }
  // Only a complete run shows that nobody gave the sink this message.
  const std::int64_t now = seen.place.time_us;
  const bool sure = context_.without_ever(kNobody, now) == Severity::kFail &&
                    context_.on_line(sink, Severity::kFail) == Severity::kFail;
  const bool held = context_.busy(sink, line->island_changed_us, now);
  const bool told = sure && !held && !soon && !line->changing(now);
  if (told && context_.half_heard(sink)) {
    context_.needs_host(sink, seen.place);
    return true;
  }
  // All sinks have one AM address, so this may be the own message of another one.
  const bool anothers = std::ranges::any_of(lines_, [&](const Line& other) {
    return other.sink != sink && net.src == machine::Address{other.island, other.am};
  });
  const bool open = anothers && !plain && !context_.device(sink).hearing;
  Passing ahead;
  ahead.net = net;
  ahead.place = seen.place;
  ahead.sure = !open;
  ahead.told = told;
  if (line->ahead.full() && line->ahead.oldest(0).passed == 0)
    invented(*line, line->ahead.oldest(0));
  line->ahead.push(ahead);
  if (context_.device(sink).whole) expire_early(*line, INT64_MAX);  // One clock.
  return true;
}

void Forwarding::invented(Line& line, const Passing& ahead) {
  if (!ahead.told) return;
  context_.report("N7-CONTENT"_rule, ahead.sure ? Severity::kFail : Severity::kInconclusive,
                  ahead.place, line.sink,
                  {"The sink radiates " + name_of(ahead.net) + "; nobody sent it this.",
                   "Its own messages, and those that came to it.",
                   {}});
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
  const bool forbidden = heard->forbidden != ReqId::kNone &&
                         (!mote || !net.sound || heard->forbidden == "N10-OFF"_rule);
  const bool right = mote && !again && !forbidden && seen.frame.dest == net.dest.devid;
  if (heard->relayed < 255) ++heard->relayed;
  const bool all = net.dest.pid == machine::kBroadcastPid && net.sound && heard->passed == 0;
  if (right || (all && !again)) return true;
  // All sinks have one AM address. So another sink may have sent it, if none of its frames was
  // found or some were taken for those of a stray sender.
  const bool anothers = std::ranges::any_of(lines_, [&](const Line& other) {
    const bool unfound = !context_.device(other.sink).radio || context_.stray_sink();
    return other.sink != line.sink && unfound && other.island == net.dest.pid;
  });
  const bool open = anothers || line.changing(seen.place.time_us);
  const Severity severity = forbidden && heard->weak ? Severity::kWeak : Severity::kFail;
  context_.report(forbidden        ? heard->forbidden
                  : mote && !again ? "N4-MOTE"_rule
                                   : "N6-ONCE"_rule,
                  context_.on_line(line.sink, open ? Severity::kInconclusive : severity),
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
  expire_early(*line, now_us);  // It may be what is missing.
  if (line->up.owed > 0) overdue_up(*line, now_us);
  if (line->down.owed > 0) overdue_down(*line, now_us);
}

void Forwarding::showed_life(std::uint16_t sink, const Observation& seen) {
  Line* const line = find(sink);
  if (line == nullptr) return;
  const bool radio = seen.kind == Observation::Kind::kRadio;
  (radio ? line->on_air : line->on_line) = seen.place;
  if (radio && line->down.owed > 0) overdue_down(*line, seen.place.time_us);
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
      if (passing.owed) --other.down.owed;
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
  return context_.busy(line.sink, from_us, passing.whole_us + context_.response_us(line.sink),
                       out) ||
         context_.crowded(line.sink, from_us);
}

void Forwarding::refuse_down(Line& line, const Observation& seen, const Net& net) {
  Passing* best = nullptr;
  for (std::size_t i = 0; i < line.down.size(); ++i) {
    Passing& passing = line.down.newest(i);
    if (!passing.came || !resembles(line, passing, net)) continue;
    if (best == nullptr || best->passed > 0) best = &passing;
  }
  Said said;
  if (same_message(best->net, net) && same_payload(best->net, net)) {
    said.text = "The sink radiates " + name_of(net) + " again.";
    said.expected = "Once for each time that it came over serial.";
    // It may have come before, too, where the capture begins later.
    const std::int64_t since_us = seen.place.time_us - context_.response_us(line.sink);
    context_.report("N2-ONCE"_rule, context_.unless_given(line.sink, since_us), seen.place,
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
  if (best->owed) --line.down.owed;
  best->owed = false;
  if (best->passed < 255) ++best->passed;
}

void Forwarding::overdue_down(Line& line, std::int64_t now_us, Severity most) {
  if (now_us < 0) return;
  for (std::size_t i = 0; i < line.down.size(); ++i) {
    Passing& passing = line.down.oldest(i);
    const std::int64_t due_us = context_.due_us(line.sink, passing.whole_us, Link::kRadio);
    if (!passing.owed || now_us <= due_us) continue;
    passing.owed = false;
    --line.down.owed;
    const bool elsewhere = std::ranges::any_of(lines_, [&](const Line& other) {
      return &other != &line && holds(other.down, passing.net, false);  // It may have radiated it.
    });
    // By another clock it may have been radiated before it came, or taken for a stray sender's.
    const bool log = context_.device(line.sink).hearing;
    const std::int64_t since_us = passing.place.time_us - (log ? 0 : context_.options.skew_us);
    const bool stray = !log && context_.stray_sink(since_us, now_us);
    const bool open = !passing.sure || elsewhere || stray || crowded(line, passing, Link::kRadio);
    const Severity severity =
        open ? Severity::kInconclusive : context_.without(line.sink, since_us, now_us);
    const Severity its = std::min(most, context_.on_line(line.sink, severity));
    const std::string proof = log            ? "The sink was given "
                              : passing.sure ? "The sink confirmed "
                                             : "Nothing proves that the sink took ";
    context_.report(passing.cut ? "N11-SHORT"_rule : "N7-RADIO"_rule,
                    passing.cut && its == Severity::kFail ? Severity::kWeak : its, passing.place,
                    line.sink,
                    {proof + name_of(passing.net) + " on its serial line and did not radiate it" +
                         (log ? "." : ", though it sent other frames later."),
                     "A radio frame to " + number(passing.am_dest) + " within " +
                         ms_text(context_.response_us(line.sink)) + ".",
                     {}});
  }
}

void Forwarding::finish() {
  for (Line& line : lines_) {
    const std::int64_t end_us = context_.end_us(line.sink);
    // At its end a log of what the sink was given needs no sign of life.
    expire_early(line, end_us + context_.options.skew_us + 1);
    if (context_.device(line.sink).hearing && line.up.owed > 0) overdue_up(line, end_us);
    if (context_.device(line.sink).hearing && line.down.owed > 0) overdue_down(line, end_us);
    // Life on the other line is one, too, if one recorder had both until the end.
    const bool both = context_.options.sniffer_complete && line.on_air.file == line.on_line.file;
    const Severity most = both ? Severity::kFail : Severity::kInconclusive;
    if (line.up.owed > 0) overdue_up(line, line.on_air.time_us - context_.options.skew_us, most);
    if (line.down.owed > 0) {
      overdue_down(line, line.on_line.time_us - context_.options.skew_us, most);
    }
    forwards_nothing(line);
    note_stale(context_, line.sink, "N6-CONTENT"_rule, line.stale,
               "On the serial line nbytes says ");
  }
}

}  // namespace rubric::check
