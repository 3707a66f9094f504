// From a sink's serial line to the radio, and what a sink owes.
#include <algorithm>

#include "conformance/check/judge/forward.h"

namespace rubric::check {

void Forwarding::pass_down(Line& line, Passing& passing, const Observation& seen, const Net& net) {
  if (passing.forbidden != ReqId::kNone) {
    const bool weak = passing.weak;
    context_.report(
        passing.forbidden, weak ? Severity::kWeak : Severity::kFail, seen.place, line.sink,
        {"The sink of island " + number(line.island) + " radiates " + name_of(net) +
             (weak ? "."
                   : ", whose nbytes is " + number(passing.net.nbytes) + " while " +
                         number(passing.net.payload.size()) + " bytes came."),
         weak ? "Another island's messages are not radiated." : "A malformed message is dropped.",
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
  if (out_of_order(passing, line.last_down)) {
    context_.report("N2-ORDER"_rule, context_.on_line(line.sink, Severity::kFail), seen.place,
                    line.sink,
                    {"The sink radiates " + name_of(net) + " after one that it got later.",
                     "Messages leave in the order in which they came.",
                     {}});
  }
}

bool Forwarding::sent_on_radio(std::uint16_t sink, const Observation& seen, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr || !line->serial) return false;
  Passing* near = nullptr;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    Passing& passing = line->down.newest(i);
    if (!same_message(passing.net, net)) {
      const bool close = passing.net.seq_num == net.seq_num && passing.net.src == net.src;
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
  // Sending on by radio what it heard for another mote of its island is legal, once (decision 115).
  for (std::size_t i = 0; i < line->up.size(); ++i) {
    Passing& passing = line->up.newest(i);
    if (passing.passed >= passing.copies || !same_message(passing.net, net) ||
        !same_payload(passing.net, net)) {
      continue;
    }
    ++passing.passed;
    return true;
  }
  if (near != nullptr) {
    refuse_down(*line, seen, net);
    return true;
  }
  // That nobody gave the sink this message, only a run shows that has everything in its order.
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
  context_.report("N7-CONTENT"_rule, Severity::kFail, seen.place, sink,
                  {"The sink radiates " + name_of(net) + "; nobody sent it this.",
                   "Its own messages, and those that came to it.",
                   {}});
  return true;
}

void Forwarding::showed_life(std::uint16_t sink, std::int64_t now_us) {
  Line* const line = find(sink);
  if (line != nullptr && line->owed_down > 0) overdue_down(*line, now_us);
}

bool Forwarding::came_down(std::uint16_t sink, const Net& net) {
  Line* const line = find(sink);
  if (line == nullptr) return false;
  for (std::size_t i = 0; i < line->down.size(); ++i) {
    const Passing& passing = line->down.newest(i);
    if (passing.passed < passing.copies && same_message(passing.net, net)) return true;
  }
  return false;
}

// Returns whether a buffer may have been full (decision 122): so many messages came around that
// time, or a line was busy.
bool Forwarding::crowded(Line& line, const Passing& passing) {
  const std::int64_t time_us = passing.place.time_us;
  if (context_.busy(line.sink, time_us, passing.whole_us + context_.response_us())) return true;
  constexpr std::size_t kCrowd = 2;
  constexpr std::int64_t kAroundUs = 100'000;
  std::size_t around = 0;
  for (Ring<Passing, kRoom>* ring : {&line.up, &line.down}) {
    for (std::size_t i = 0; i < ring->size(); ++i) {
      const std::int64_t apart = ring->oldest(i).place.time_us - time_us;
      if (apart > -kAroundUs && apart < kAroundUs) ++around;
    }
  }
  return around > kCrowd;
}

void Forwarding::somebody_sent(const Net& net) {
  for (Line& line : lines_) {
    if (context_.device(line.sink).whole) continue;  // Its log would have it.
    for (std::size_t i = 0; i < line.down.size(); ++i) {
      Passing& passing = line.down.newest(i);
      if (!same_message(passing.net, net)) continue;
      if (passing.owed) --line.owed_down;
      passing.owed = false;
      if (passing.copies < 255) ++passing.copies;  // It may have been another's.
      break;
    }
  }
}

void Forwarding::refuse_down(Line& line, const Observation& seen, const Net& net) {
  Passing* best = nullptr;
  for (std::size_t i = 0; i < line.down.size(); ++i) {
    Passing& passing = line.down.newest(i);
    if (passing.net.seq_num != net.seq_num || passing.net.src != net.src) continue;
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

// Returns whether the same message came down another sink's line, which may have radiated it.
bool Forwarding::also_elsewhere(const Line& line, const Net& net) {
  return std::any_of(lines_.begin(), lines_.end(), [&](Line& other) {
    if (&other == &line) return false;
    for (std::size_t i = 0; i < other.down.size(); ++i) {
      if (same_message(other.down.newest(i).net, net)) return true;
    }
    return false;
  });
}

// Reports what was surely received and is missing though the sink has shown life long after.
void Forwarding::overdue_up(Line& line, std::int64_t now_us) {
  if (now_us < 0) return;
  for (std::size_t i = 0; i < line.up.size(); ++i) {
    Passing& passing = line.up.oldest(i);
    if (!passing.owed || now_us <= context_.due_us(line.sink, passing.whole_us)) continue;
    passing.owed = false;
    --line.owed_up;
    const bool own_island = passing.net.dest.pid == line.island;
    context_.report(
        own_island ? "N6-FORWARD"_rule : "N6-ROUTE"_rule,
        crowded(line, passing) || context_.who.damaged(passing.place.time_us, now_us)
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
    if (!passing.owed || now_us <= context_.due_us(line.sink, passing.whole_us)) continue;
    passing.owed = false;
    --line.owed_down;
    const bool open = !passing.sure || crowded(line, passing) || also_elsewhere(line, passing.net);
    const Severity severity =
        open ? Severity::kInconclusive : context_.without(line.sink, passing.place.time_us, now_us);
    context_.report("N7-RADIO"_rule, context_.on_line(line.sink, severity), passing.place,
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

}  // namespace rubric::check
