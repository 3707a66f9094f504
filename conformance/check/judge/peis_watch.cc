#include "conformance/check/judge/peis_watch.h"

#include <algorithm>

#include "conformance/machine/route.h"

namespace rubric::check {
namespace {

using machine::Link;
using machine::Role;
using Onward = machine::Route::Onward;

// How long a host waits for the confirmation of a packet before it sends the next one.
constexpr std::int64_t kConfirmationUs = 1'100'000;
constexpr std::size_t kPeisCrowd =
    2;  // So many at once may have found a buffer full (decision 122).

machine::Router base_station(machine::Address own, std::uint16_t sink_am) {
  return {Role::kBaseStation, own, true, sink_am};
}

}  // namespace

PeisWatch::PeisWatch(Context& context, std::size_t devices) : context_(context), bases_(devices) {}

PeisWatch::Message* PeisWatch::match(Messages& messages, const Net& net) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    Message& message = messages.oldest(i);
    if (message.passed || !message.came) continue;
    if (same_message(message.net, net) && same_payload(message.net, net)) return &message;
  }
  return nullptr;
}

void PeisWatch::came_up(std::uint16_t base, std::uint16_t island, const Observation& seen,
                        const Net& net, bool on) {
  if (!context_.logs_peis(base) || island == kNoIsland) return;
  const machine::Route route =
      machine::route_received(base_station({island, machine::kNullDevid}, context_.sink_am),
                              Link::kSerial, net.dest, net.src);
  // It may pass a broadcast to every island on, once, or not (decision 114).
  const bool onward = route.onward == Onward::kPeis;
  if (!onward && net.dest.pid != machine::kBroadcastPid) return;
  const bool given = seen.received;
  Message& message = bases_[base].up.push({net, seen.place, onward && given && on && net.sound});
  message.came = given || !context_.device(base).whole;
}

void PeisWatch::came_while_off(std::uint16_t base, const Net& net, bool off) {
  Messages& up = bases_[base].up;
  for (std::size_t i = 0; i < up.size(); ++i) {
    Message& message = up.newest(i);
    if (!same_message(message.net, net)) continue;
    message.came = true;
    message.off = off;
    return;
  }
}

void PeisWatch::switched(std::uint16_t base, bool on, std::int64_t now_us) {
  Messages& down = bases_[base].down;
  if (!on) overdue(base, down, false, now_us, false);
  for (std::size_t i = 0; i < down.size(); ++i) {
    Message& message = down.newest(i);
    if (on && message.held) {
      message.owed = !message.passed;
      message.given_us = now_us;
    }
    message.held = !on && (message.owed || message.held);
    if (!on) message.owed = false;
  }
}

void PeisWatch::surely_up(std::uint16_t base, const Net& net, std::int64_t now_us) {
  Messages& up = bases_[base].up;
  for (std::size_t i = 0; i < up.size(); ++i) {
    Message& message = up.newest(i);
    if (!same_message(message.net, net)) continue;
    message.owed = !message.passed && net.sound && net.dest.pid != machine::kBroadcastPid;
    message.given_us = now_us;
    message.came = true;
    message.net = net;  // As it was given, perhaps without the bytes after its content.
    return;
  }
}

bool PeisWatch::sent(std::uint16_t base, const Observation& seen, const Net& net,
                     machine::Address own, bool first) {
  Base& watch = bases_[base];
  const bool all = net.dest.pid == machine::kBroadcastPid;
  const bool stray = seen.frame.dest != net.dest.pid || (net.dest.pid == own.pid && !all);
  if (stray) {
    context_.report(
        "N8-PEIS"_rule, Severity::kFail, seen.place, base,
        {"Through PEIS " + name_of(net) + " goes to island " + number(seen.frame.dest) + ".",
         net.dest.pid == own.pid ? "A message for the own island stays there."
                                 : "Island " + number(net.dest.pid) + ".",
         {}});
  } else {
    context_.findings.kept("N8-PEIS"_rule);
  }
  // Its own comes up, too, where its sink hears what another island's radiates.
  if (first && net.src == own) return !stray;
  Message* const came = match(watch.up, net);
  if (came == nullptr && net.src == own) return !stray;
  if (came != nullptr) {
    came->passed = true;
    came->owed = false;
    if (came->off) {
      context_.report("N10-OFF"_rule, Severity::kFail, seen.place, base,
                      {"The base station puts " + name_of(net) +
                           " on PEIS, which came while its serial interface was off.",
                       "What is switched off receives nothing.",
                       {}});
    }
  } else if (!stray) {
    refuse(base, seen, net, watch.up, true);
  }
  overdue(base, watch.up, true, seen.place.time_us, false);
  return false;
}

void PeisWatch::given(std::uint16_t base, const Observation& seen, const Net& net,
                      machine::Address own, bool serial_off) {
  const machine::Route route =
      machine::route_received(base_station(own, context_.sink_am), Link::kPeis, net.dest, net.src);
  const bool onward = route.onward == Onward::kSerial && net.sound;
  // A base station may pass a broadcast to every island on, or not (decision 114).
  if (onward || net.dest.pid == machine::kBroadcastPid) {
    bases_[base].down.push({net, seen.place, onward && !serial_off});
  }
}

void PeisWatch::went_down(std::uint16_t base, const Observation& seen, const Net& net) {
  if (!context_.logs_peis(base)) return;
  Base& watch = bases_[base];
  Message* const came = match(watch.down, net);
  if (came == nullptr) {
    if (!watch.moved) refuse(base, seen, net, watch.down, false);
  } else {
    came->passed = true;
    came->owed = false;
    context_.findings.kept("N8-INCOMING"_rule);
  }
  overdue(base, watch.down, false, seen.place.time_us, false);
}

// Reports a message that matches nothing that came and is not yet passed on.
void PeisWatch::refuse(std::uint16_t base, const Observation& seen, const Net& net,
                       Messages& messages, bool up) {
  const std::string way = up ? "through PEIS" : "to its sink";
  const std::string origin = up ? "its sink sent" : "PEIS gave it";
  Message* other = nullptr;
  for (std::size_t i = 0; i < messages.size() && other == nullptr; ++i) {
    Message& message = messages.newest(i);
    const bool near = message.net.src == net.src &&
                      (message.net.seq_num == net.seq_num ||
                       (message.net.dest == net.dest && equal(message.net.payload, net.payload)));
    if (near) other = &message;
  }
  Said said;
  said.text =
      "The base station hands " + name_of(net) + ", reliable " + number(net.reliable) + ", " + way;
  said.expected = "What " + origin + ", once, with addresses, reliable, number and payload.";
  if (other == nullptr) {
    said.text += "; nothing that " + origin + " was this.";
  } else if (other->passed && same_message(net, other->net) && same_payload(net, other->net)) {
    said.text += " again.";
  } else {
    said.text += "; " + origin + " " + name_of(other->net) + ", reliable " +
                 number(other->net.reliable) + ", " + number(other->net.payload.size()) + " bytes.";
    other->passed = true;
    other->owed = false;
  }
  const bool escaped = other == nullptr && !context_.options.start_cold;
  context_.report(up ? "N8-PEIS"_rule : "N8-INCOMING"_rule,
                  escaped ? Severity::kInconclusive : Severity::kFail, seen.place, base,
                  std::move(said));
}

void PeisWatch::overdue(std::uint16_t base, Messages& messages, bool up, std::int64_t now_us,
                        bool end) {
  if (!context_.run.has_time) return;
  const std::int64_t confirmed_us = end && !up ? kConfirmationUs : 0;
  const Link line = up ? Link::kPeis : Link::kSerial;
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) waiting += messages.oldest(i).owed ? 1 : 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    Message& message = messages.oldest(i);
    const std::int64_t since_us = std::max(message.place.time_us, message.given_us);
    if (!message.owed || now_us <= context_.due_us(base, since_us, line) + confirmed_us) continue;
    message.owed = false;
    context_.report(up ? "N8-PEIS"_rule : "N8-INCOMING"_rule,
                    waiting > kPeisCrowd || context_.full(base, since_us) ? Severity::kInconclusive
                                                                          : Severity::kFail,
                    message.place, base,
                    {"The base station got " + name_of(message.net) + " from " +
                         (up ? "its sink and did not put it on PEIS."
                             : "PEIS and did not hand it to its sink."),
                     "That message, unchanged, within " + ms_text(context_.response_us(base)) + ".",
                     {}});
  }
}

void PeisWatch::asked_island(std::uint16_t base, const Observation& call, std::uint16_t island,
                             bool owes) {
  bases_[base].called = true;
  if (owes) bases_[base].asked.push_back({call.place, island});
}

void PeisWatch::refused_island(std::uint16_t base, std::uint16_t island) {
  std::vector<Asked>& asked = bases_[base].asked;
  if (!asked.empty() && asked.back().island == island) asked.pop_back();
}

void PeisWatch::told_island(std::uint16_t base, const Observation& seen, std::int32_t island) {
  const auto config = rubicon::ConfigView::parse(seen.frame.payload);
  if (config && config->type() == rubicon::CommandCode::kSetIslandId && island < 0) {
    context_.report(
        "N9-OTHER"_rule, Severity::kFail, seen.place, base,
        {"The base station sets island " + number(config->value()) + ", which is reserved.",
         "It refuses the call, and its sink is told nothing.",
         {}});
    return;
  }
  std::vector<Asked>& asked = bases_[base].asked;
  const std::uint16_t own = context_.device(base).island;
  const bool other = island >= 0 && own != kNoIsland && island != own;
  if (other && context_.device(base).whole && !bases_[base].called) {
    context_.report("N9-SET"_rule, Severity::kFail, seen.place, base,
                    {"The base station of island " + number(own) + " sets island " +
                         number(static_cast<std::uint64_t>(island)) +
                         " at its sink, and no call asked for that.",
                     "Its own island, or none.",
                     {}});
  }
  if (asked.empty()) return;
  const std::uint16_t due = asked.front().island;
  asked.erase(asked.begin());
  if (island == due) return context_.findings.kept("N9-SET"_rule);
  context_.report(
      "N9-SET"_rule, Severity::kFail, seen.place, base,
      {"After the call that sets island " + number(due) + " the config message to the sink sets " +
           (island < 0 ? "none." : number(static_cast<std::uint64_t>(island)) + "."),
       "SET_ISLAND_ID with the island of the call.",
       {}});
}

void PeisWatch::overdue_island(std::uint16_t base, std::int64_t now_us) {
  std::vector<Asked>& asked = bases_[base].asked;
  if (asked.empty() || !context_.run.has_time) return;
  const Asked& first = asked.front();
  if (now_us <= context_.due_us(base, first.place.time_us, Link::kSerial)) return;
  context_.report(
      "N9-SET"_rule, Severity::kFail, first.place, base,
      {"The application sets island " + number(first.island) +
           ", and the sink is not told within " + ms_text(context_.response_us(base)) + ".",
       "A config message SET_ISLAND_ID to the sink.",
       {}});
  asked.erase(asked.begin());
}

void PeisWatch::overdue(std::uint16_t base, std::int64_t now_us) {
  overdue_island(base, now_us);
  overdue(base, bases_[base].up, true, now_us, false);
  overdue(base, bases_[base].down, false, now_us, false);
}

void PeisWatch::finish() {
  for (std::size_t base = 0; base < bases_.size(); ++base) {
    const auto index = static_cast<std::uint16_t>(base);
    const std::int64_t end_us = context_.end_us(index);
    overdue_island(index, end_us);
    overdue(index, bases_[base].up, true, end_us, true);
    overdue(index, bases_[base].down, false, end_us, true);
  }
}

}  // namespace rubric::check
