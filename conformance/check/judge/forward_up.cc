// What a sink passes on from its radio to its serial line.
#include <algorithm>

#include "conformance/check/judge/forward.h"
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
                                std::uint16_t surely_received_by, std::uint16_t off) {
  for (Line& line : lines_) {
    if (line.sink == sender || !line.serial) continue;
    // A sink with a log of what it was given hears nothing else, and hears it in its own order.
    const bool sure = surely_received_by == line.sink;
    const bool is_off = off == line.sink;
    if (context_.device(line.sink).hearing ? !sure && !is_off : seen.received) continue;
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
    } else if (line.island == kNoIsland) {
      // It may be this sink's or not, and be sent up when the island is known.
    } else if (!onward && !route.deliver && net.dest.pid != machine::kBroadcastPid) {
      passing.forbidden = route.requirement;
      passing.weak = route.requirement == "N6-OTHER"_rule;
    }
    if (is_off) passing.forbidden = "N10-OFF"_rule;
    passing.owed = onward && line.island != kNoIsland && !line.off && !line.deaf && net.sound &&
                   net.reliable <= 1 && net.src.pid == line.island && sure;
    line.heard += onward && !is_off && net.sound && net.src.pid == line.island ? 1 : 0;
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
      // A whole log has one clock, and what a sink does after its cause.
      if (context_.device(line.sink).whole) unheard(line, before);
      break;
    }
    store(line.up, passing);
    if (early && passing.forbidden != ReqId::kNone) pass_up(line, line.up.newest(0), seen);
  }
}

void Forwarding::pass_up(Line& line, Passing& passing, const Observation& seen) {
  if (passing.forbidden != ReqId::kNone) {
    if (line.changing(passing.place.time_us)) return;
    Said said;
    const Net& net = passing.net;
    const bool stale = line.last_island != kNoIsland &&
                       (net.dest.pid == line.last_island || net.src.pid == line.last_island);
    if (passing.forbidden == "N6-COLLISION"_rule && stale) passing.forbidden = "N9-SET"_rule;
    if (passing.forbidden == "N11-NBYTES"_rule) {
      said.text = "The sink forwards " + name_of(passing.net) + ", whose nbytes is " +
                  number(passing.net.nbytes) + " while " + number(passing.net.payload.size()) +
                  " bytes came.";
      said.expected = "A malformed message is dropped.";
    } else if (passing.forbidden == "N10-OFF"_rule) {
      said.text =
          "The sink forwards " + name_of(passing.net) + ", which came while its radio was off.";
      said.expected = "What is switched off receives nothing.";
    } else {
      said.text = "The sink of island " + number(line.island) + " forwards " +
                  name_of(passing.net) + " to its base station.";
      said.expected = "It is ignored: neither its destination nor its source makes it this sink's.";
    }
    const bool format = passing.forbidden == "N11-NBYTES"_rule;
    Severity severity = passing.weak ? Severity::kWeak : Severity::kFail;
    if (!format) severity = context_.on_line(line.sink, severity);  // SET_ISLAND_ID may be missing.
    const bool of_island = !format && passing.forbidden != "N10-OFF"_rule;
    if (of_island && context_.half_heard(line.sink)) {
      return context_.needs_host(line.sink, seen.place);
    }
    const std::int64_t known_us = std::max(line.island_changed_us, line.island_shown_us);
    const bool lost =  // Perhaps its power, and that island.
        of_island && line.told &&
        context_.may_have_restarted(line.sink, known_us, seen.place.time_us);
    if (!format && (!line.island_sure || lost || context_.after_begin(passing.place.time_us))) {
      severity = std::min(severity, Severity::kInconclusive);
    }
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
  expire_early(*line, now);
  for (std::size_t i = 0; i < line->up.size(); ++i) {
    Passing& passing = line->up.newest(i);
    if (passing.passed >= passing.copies || !same_message(passing.net, net) ||
        !begins_with(net, passing.net)) {
      continue;
    }
    ++passing.passed;
    if (passing.owed) --line->up.owed;
    passing.owed = false;
    if (!net.sound && passing.net.sound) {
      report_nbytes(context_, line->sink, seen.place, net);
    } else if (passing.net.sound && net.nbytes > passing.net.nbytes) {
      line->stale.add(seen.place, passing.net.nbytes, net.nbytes);
    }
    pass_up(*line, passing, seen);
    if (line->up.owed > 0) overdue_up(*line, now);
    return;
  }
  if (line->up.forgotten > 0) {
    --line->up.forgotten;
  } else {
    refuse_up(*line, seen, net);
  }
  if (line->up.owed > 0) overdue_up(*line, now);
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
  if (!(context_.who.sees_air || context_.device(line.sink).whole) || line.island == kNoIsland)
    return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.newest(i);
    if (passing.net.seq_num != net.seq_num || passing.net.src != net.src) continue;
    const bool same = same_message(passing.net, net) && begins_with(net, passing.net);
    if (same && context_.comes(line.sink, seen, net.src, net.seq_num)) break;
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
    if (passing.owed) --line.up.owed;
    passing.owed = false;
    return;
  }
  Passing early;
  early.net = net;
  early.place = seen.place;
  if (line.early.full() && line.early.oldest(0).passed == 0) unheard(line, line.early.oldest(0));
  line.early.push(early);
}

// Reports frames of one tap for which none came by the other, not even within the skew of the taps.
void Forwarding::expire_early(Line& line, std::int64_t now_us) {
  for (std::size_t i = 0; i < line.ahead.size(); ++i) {
    Passing& ahead = line.ahead.oldest(i);
    if (ahead.passed != 0 || now_us - ahead.place.time_us <= context_.options.skew_us) continue;
    ahead.passed = 1;
    invented(line, ahead);
  }
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
  // It may be the sink's own message: its host, which nobody hears, may have set another island.
  if (meant == nullptr && early.net.src.devid == line.am && context_.half_heard(line.sink)) {
    return context_.needs_host(line.sink, early.place);
  }
  const bool began =
      context_.options.start_cold || early.place.time_us - context_.run.start_us > kStartUs;
  // A damaged frame may have been what it forwards.
  const std::int64_t at_us = early.place.time_us;
  const bool damaged = context_.who.damaged(at_us - context_.response_us(line.sink),
                                            at_us + context_.options.skew_us);
  const bool moved = !line.island_sure && early.net.src.devid == line.am;  // To another island.
  const bool complete = context_.options.sniffer_complete && began && !damaged && !moved;
  const Severity severity = complete ? Severity::kFail : Severity::kInconclusive;
  if (meant != nullptr && complete) {
    if (meant->owed) --line.up.owed;
    meant->owed = false;
    meant->passed = 1;
    context_.report("N6-CONTENT"_rule, severity, early.place, line.sink,
                    {"The sink forwards " + name_of(early.net) + "; what it received was " +
                         name_of(meant->net) + ".",
                     "Addresses, reliable, number and payload as they were heard.",
                     {}});
    return;
  }
  const bool another = std::ranges::any_of(
      lines_, [&](const Line& other) { return other.island == early.net.src.pid; });
  const bool own = early.net.src.devid == line.am && !another;
  const bool told =
      own && line.told && context_.options.start_cold;  // And acts for its former one.
  context_.report(
      told ? "N9-SET"_rule : "N6-ONCE"_rule, severity, early.place, line.sink,
      {"The sink puts " + name_of(early.net) + " on its serial line; nobody was heard sending it.",
       told ? "Messages of its own from island " + number(line.island) + ", which it was told."
            : "A message that a mote sent.",
       {}});
}

bool Forwarding::alters_up(std::uint16_t sink, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr || net.src.devid != line->am) return false;
  for (std::size_t i = 0; i < line->up.size(); ++i) {
    const Passing& passing = line->up.newest(i);
    if (passing.net.seq_num != net.seq_num) continue;  // Of most, so this is asked first.
    const bool waits = passing.passed == 0 && passing.forbidden == ReqId::kNone;
    if (waits && passing.net.dest == net.dest && passing.net.src != net.src &&
        begins_with(net, passing.net)) {
      return true;
    }
  }
  return false;
}

void Forwarding::went_up(std::uint16_t sink, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line != nullptr && line->up.owed > 0) overdue_up(*line, now_us);
}

bool Forwarding::came_up(std::uint16_t sink, const Net& net) {
  const Line* const line = find(sink);
  return line != nullptr && holds(line->up, net, true);
}

// Reports what was surely received and is missing though the sink has shown life long after.
void Forwarding::overdue_up(Line& line, std::int64_t now_us, Severity most) {
  if (now_us < 0) return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.oldest(i);
    const std::int64_t due_us = context_.due_us(line.sink, passing.whole_us, Link::kSerial);
    if (!passing.owed || now_us <= due_us) continue;
    passing.owed = false;
    --line.up.owed;
    const bool own_island = passing.net.dest.pid == line.island;
    const bool log = context_.device(line.sink).hearing;
    context_.report(
        own_island ? "N6-FORWARD"_rule : "N6-ROUTE"_rule,
        crowded(line, passing, Link::kSerial) || context_.who.damaged(passing.place.time_us, now_us)
            ? Severity::kInconclusive
            : std::min(most, context_.absent_on_line(line.sink, Severity::kFail)),
        passing.place, line.sink,
        {"The sink received " + name_of(passing.net) + " (" +
             (log ? "by its log" : "the link acknowledged it") +
             ") and did not put it on its serial line" +
             (log ? "." : ", though it sent other frames later."),
         "A forward within " + ms_text(context_.response_us(line.sink)) + ".",
         {}});
  }
}

// Says that of many messages not one left on the line: nothing proves that any of them arrived.
void Forwarding::forwards_nothing(const Line& line) {
  const bool silent = line.forwarded == 0 && line.heard >= kSilent;
  if (!line.serial || !silent || line.up.size() == 0) return;
  const Passing& last = line.up.newest(0);
  context_.report(
      "N6-FORWARD"_rule, Severity::kInconclusive, last.place, line.sink,
      {"Of the messages to its base station the sink has forwarded none, " + number(line.heard) +
           " up to " + name_of(last.net) + "; nothing proves that one arrived.",
       "Forwards of those that arrived.",
       {}});
}

}  // namespace rubric::check
