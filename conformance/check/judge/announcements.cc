#include "conformance/check/judge/announcements.h"

#include <algorithm>

namespace rubric::check {
namespace {

constexpr std::int64_t kFrameUs = 12'000;  // A whole message on a serial line of 115,200 baud.

}  // namespace

using machine::Admission;

void Announcements::report(std::uint16_t sink_device, const Observation& seen, const Net& net,
                           const SerialJoined& joined) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink == nullptr) return;
  if (sink->island == kNoIsland) sink->island = joined.address.pid;
  const machine::Address to{joined.address.pid, machine::kNullDevid};
  machine::Address member = joined.address;
  if (net.src != joined.address || net.dest != to || net.reliable != 0) {
    context_.report(
        "J6-CONTENT"_rule, Severity::kFail, seen.place, sink_device,
        {"serial_joined of " + text_of(joined.address) + " in a net_msg from " + text_of(net.src) +
             " to " + text_of(net.dest) + ", reliable " + number(net.reliable) + ".",
         "From " + text_of(joined.address) + " to " + text_of(to) + ", reliable 0.",
         {}});
    // With a wrong address inside it is still the report of the member that it comes from.
    if (!owes(*sink, member.devid) && owes(*sink, net.src.devid)) member = net.src;
    if (member.devid == net.src.devid && net.src.pid == sink->island) member = net.src;
  }
  announce(*sink, seen.place, member, joined.descriptor, false);
}

// Returns whether by all that is possible the sink owes the report of that mote.
bool Announcements::owes(const SinkWatch& sink, std::uint16_t mote_am) {
  const auto found = sink.motes.find(mote_am);
  return found != sink.motes.end() && !found->second.set.empty() &&
         std::ranges::all_of(found->second.set, &SinkHypothesis::owes_report);
}

void Announcements::told(std::uint16_t sink_device, const Observation& seen,
                         const machine::MoteJoined& joined) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink == nullptr) return;
  const std::uint16_t am = joined.address.devid;
  if (context_.device(sink_device).whole) forgets(sink_device, am, seen.place.time_us);
  announce(*sink, seen.place, joined.address, joined.descriptor, true);
}

// Judges serial_joined, or moteJoined (`notice`), of a mote.
void Announcements::announce(SinkWatch& sink, const Place& at, machine::Address address,
                             const machine::Descriptor& descriptor, bool notice) {
  PairWatch& watch = joins_.pair(sink, address.devid);
  const ReqId content = notice ? "J6-ADD"_rule : "J6-CONTENT"_rule;
  // An ack_join may be repeated after its sink was told another island.
  const bool before =
      watch.admitted.frame != 0 && watch.asked && watch.admitted.time_us >= watch.request.time_us;
  const Place& cause = before ? watch.admitted : watch.ack;
  const bool astray =
      address.pid != sink.island && !joins_.keeps_former(sink, address.pid, at, cause.time_us);
  // The host of a line that is only half heard may have set another island.
  const bool told = astray && context_.half_heard(sink.device);
  if (told) context_.needs_host(sink.device, at);
  if (astray && !told) {
    const ReqId rule = SinkJoins::wrong_island(sink, address.pid, content);
    // SET_ISLAND_ID may have escaped, or found the line switched off.
    const Severity severity = sink.island_sure ? Severity::kFail : Severity::kInconclusive;
    context_.report(rule, context_.on_line(sink.device, severity), at, sink.device,
                    {"A new member " + text_of(address) + " is announced by the sink of island " +
                         number(sink.island) + ".",
                     "Its address in island " + number(sink.island) + ".",
                     {}});
  }
  next_.clear();
  std::optional<machine::Descriptor> stored;
  for (const SinkHypothesis& h : watch.set) {
    SinkHypothesis next = h;
    if (h.unknown) {
      next.unknown = false;
      next.member = Admission{address.devid, 0, descriptor};
      if (h.pending) next.member->seq_num = h.pending->seq_num;
      next.owes_report = notice && !context_.device(sink.device).taps.empty();
      next.owes_notice = !notice && context_.device(sink.device).application;
      next_.push_back(next);
      stored = descriptor;
      continue;
    }
    bool& owes = notice ? next.owes_notice : next.owes_report;
    if (!owes) continue;
    owes = false;
    // One that has forgotten the mote since still owes what it had to say of it.
    if (h.member && (!stored || *stored != descriptor)) stored = h.member->descriptor;
    next_.push_back(next);
  }
  if (watch.report_due && !notice) {
    sink.set_due(watch, false);
    context_.left(sink.device, machine::Link::kSerial, at, watch.admitted_us,
                  context_.handled_us(sink.device, watch.admitted_us, at.time_us),
                  "serial_joined of mote " + number(address.devid));
  }
  if (next_.empty()) {
    refuse_report(sink, watch, at, {address.devid, 0, descriptor}, notice, astray);
    return;
  }
  if (!notice && watch.admitted.frame != 0) {
    sink.reported_us = std::max(sink.reported_us, watch.admitted.time_us);
  }
  if (stored && *stored != descriptor) {
    // A sink with one memory for all motes announces the descriptor of another mote's request.
    const auto others = [&](const auto& other) {
      const auto has = [&](const SinkHypothesis& h) {
        return (h.pending && h.pending->descriptor == descriptor) ||
               (h.member && h.member->descriptor == descriptor);
      };
      return other.first != address.devid && other.second.asked && watch.asked &&
             other.second.request.time_us >= watch.request.time_us &&
             std::ranges::any_of(other.second.set, has);
    };
    context_.report(
        std::ranges::any_of(sink.motes, others) ? "J9-INTERLEAVE"_rule : content, Severity::kFail,
        at, sink.device,
        {"The descriptor of " + text_of(address) + " is announced as type " +
             number(descriptor.mote_type) + ", transducers " + number(descriptor.transducers) +
             ", actuators " + number(descriptor.actuators) + ".",
         "Type " + number(stored->mote_type) + ", transducers " + number(stored->transducers) +
             ", actuators " + number(stored->actuators) + ", as requested.",
         {}});
  } else {
    context_.findings.kept(content);
    context_.findings.kept(notice ? "J6-ADD"_rule : "J6-REPORT"_rule);
  }
  joins_.keep(sink, watch, next_, at);
  const std::size_t members = joins_.listed(sink);
  const std::uint8_t members_max = context_.profile(sink.device).members_max;
  if (members > members_max) {
    context_.report("J3-FULL"_rule, Severity::kWeak, at, sink.device,
                    {"Member " + number(members) + " of the sink is announced.",
                     "At most " + number(members_max) + " members.",
                     {}});
  }
}

void Announcements::refuse_report(SinkWatch& sink, PairWatch& watch, const Place& at,
                                  const Admission& announced, bool notice, bool astray) {
  const std::uint16_t mote_am = announced.devid;
  const std::string what = notice ? "moteJoined" : "serial_joined";
  const auto its_ack = [&](const Observation& seen) {
    AckJoin ack;
    return seen.kind == Observation::Kind::kRadio && seen.frame.type == am::kAckJoin &&
           parse_ack_join(seen.frame.payload, ack) && ack.src.devid == mote_am &&
           ack.dest.pid == sink.island;
  };
  const bool open = !context_.device(sink.device).whole && at.timed();
  const Observation* const ack = open ? context_.soon(at.time_us, its_ack) : nullptr;
  // In one file the order of its frames tells which came first, if it does so of other frames.
  const bool one_file = ack != nullptr && ack->place.file == at.file;
  const bool later = one_file && ack->place.frame > at.frame;
  if (ack != nullptr && (!later || context_.taps_cross().air_us > 0)) {
    watch.know_nothing();
    watch.ahead_us = at.time_us;
    if (one_file && !later) return;
    context_.report("J6-ONLY"_rule, Severity::kInconclusive, at, sink.device,
                    {what + " of mote " + number(mote_am) + ", whose ack_join came " +
                         "later by less than two clocks may differ.",
                     what + " only after an ack_join with the number of the request.",
                     {}});
    return;
  }
  const SinkHypothesis& h = watch.set.back();
  Said said;
  for (auto it = watch.set.rbegin(); it != watch.set.rend(); ++it) {
    said.hypotheses.push_back({SinkJoins::sentence(*it), "No announcement of this mote.",
                               "The mote is announced as a new member."});
  }
  ReqId rule = "J6-ADD"_rule;
  const bool has_ack = watch.ack.frame != 0;
  // The request to which the ack belongs may have escaped as well.
  std::int64_t since = context_.run.start_us - 1;
  if (has_ack && watch.asked) since = std::min(watch.ack.time_us, watch.request.time_us);
  Severity severity = context_.without_mote(mote_am, since, at.time_us, sink.device);
  const bool may_have_come = !context_.options.start_cold || context_.lossy_air;
  if (!has_ack && may_have_come) severity = Severity::kInconclusive;
  if (h.member) {
    rule = "J6-REPEAT"_rule;
    severity = context_.on_line(sink.device, severity);  // Its island may have been set.
    if (sink.perhaps_told) severity = std::min(severity, Severity::kInconclusive);
    // With an ack_join of a later request only the reply between them may be missing.
    if (watch.asked && has_ack && watch.request.time_us <= watch.ack.time_us &&
        watch.answered_seq != watch.request_seq) {
      severity =
          std::min(severity, context_.without(sink.device, watch.request.time_us, at.time_us));
    }
    said.text = what + " of mote " + number(mote_am) + " again, without a new join.";
    said.expected = "One " + what + " for each join; a repeated ack_join changes nothing.";
  } else if (watch.ignored_ack == "J6-SENDER"_rule) {
    rule = "J6-SENDER"_rule;
    if (severity == Severity::kFail) severity = Severity::kWeak;
    said.text = what + " of mote " + number(mote_am) +
                ", whose only ack_join is not for this sink's devid, or not from <its island, its "
                "AM source>.";
    said.expected = "That ack_join is ignored.";
  } else if (watch.ignored_ack == "J6-SEQ"_rule || watch.ignored_ack == "J6-ISLAND"_rule) {
    rule = watch.ignored_ack;
    severity = context_.on_line(sink.device, severity);  // Its island may have been set.
    // Of two motes with one devid it may have stored the number of each.
    const std::uint16_t mote = context_.mote_of_am[mote_am];
    const bool namesakes = mote != kNobody && context_.next_of_am[mote] != kNobody;
    if (namesakes && at.time_us <= context_.due_us(sink.device, watch.own_ack_us)) {
      rule = "J6-SEQ"_rule;
      severity = std::min(severity, Severity::kInconclusive);
    }
    said.text = what + " of mote " + number(mote_am) + ", whose only ack_join had " +
                (rule == "J6-SEQ"_rule ? "a number that was not its request's."
                                       : "another island as its destination.");
    said.expected = "That ack_join is ignored.";
  } else {
    if (!has_ack) rule = "J6-ONLY"_rule;
    said.text = what + " of mote " + number(mote_am) + ", which has sent no ack_join to this sink.";
    said.expected = what + " only after an ack_join with the number of the request.";
  }
  // A sink that acts for another island takes that island's ack_joins: one cause, which is said.
  if (!astray || rule != "J6-ISLAND"_rule) {
    context_.report(rule, severity, at, sink.device, std::move(said));
  }
  SinkHypothesis next = h;
  next.unknown = false;
  const std::uint16_t seq_num = next.pending ? next.pending->seq_num : watch.request_seq;
  if (!next.member) {
    next.member = announced;
    next.member->seq_num = seq_num;
    const Device& device = context_.device(sink.device);  // The other of the two may follow.
    next.owes_report = notice && device.shows_line();
    next.owes_notice = !notice && device.application;
  }
  next.pending.reset();  // It heard an ack_join that the capture does not have.
  watch.set.assign(1, next);
}

void Announcements::showed_life(std::uint16_t sink_device, std::int64_t now_us) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink == nullptr || now_us < 0) return;
  sink->behind = sink->serial_us >= 0 && now_us - sink->serial_us <= kFrameUs;
  sink->serial_us = now_us;
  if (sink->debts > 0) overdue_reports(*sink, kNotEnded);
}

void Announcements::serial_set(std::uint16_t sink_device, bool on, std::int64_t now_us) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink == nullptr) return;
  sink->serial_off = !on;
  if (on) sink->serial_on_us = now_us;
  if (on || context_.device(sink_device).whole) return;  // Reports wait until it is on again.
  for (auto& [am, watch] : sink->motes) sink->set_due(watch, false);
}

void Announcements::overdue(std::uint16_t sink_device, std::int64_t now_us) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink != nullptr && sink->debts > 0) overdue_reports(*sink, now_us);
}

void Announcements::overdue_reports(SinkWatch& sink, std::int64_t end_us) {
  std::vector<std::uint16_t> due;
  if (sink.serial_off) return;
  const bool end = end_us != kNotEnded;
  const bool whole = context_.device(sink.device).whole;
  const std::int64_t now_us = whole && end ? end_us : sink.serial_us;
  for (const auto& [am, watch] : sink.motes) {
    const std::int64_t due_us =
        context_.due_us(sink.device, std::max(watch.admitted_us, sink.serial_on_us),
                        machine::Link::kSerial) +
        (sink.behind ? kFrameUs : 0);
    const bool ahead = watch.is_ahead(context_.options.skew_us);
    const bool comes = now_us < watch.comes_us;
    if (watch.report_due && now_us > due_us && !ahead && !comes) due.push_back(am);
  }
  std::sort(due.begin(), due.end(), [&](std::uint16_t a, std::uint16_t b) {
    return std::pair(sink.motes[a].admitted.time_us, a) <
           std::pair(sink.motes[b].admitted.time_us, b);
  });
  for (const std::uint16_t am : due) {
    PairWatch& watch = sink.motes[am];
    // Its list may be full of members from before the capture, or of some whose joins came damaged,
    // unless it has taken a later one.
    const bool few = sink.motes.size() <= context_.profile(sink.device).members_max;
    const bool all = context_.options.start_cold &&
                     (few || !context_.who.damaged(context_.run.start_us, watch.admitted.time_us));
    const bool room = all || sink.reported_us > watch.admitted.time_us;
    if (!room && !end) continue;
    // A late one passes (decision 125), but for a whole log, unless the mote asks again before.
    const auto is_report = [am](const Observation& seen) {
      Net net;
      SerialJoined joined;
      return seen.kind == Observation::Kind::kSerial && !seen.to_mote && !seen.received &&
             parse_net(seen.frame.payload, net) && parse_serial_joined(net, joined) &&
             joined.address.devid == am;
    };
    const auto is_next = [&](const Observation& seen) {
      const bool asks = seen.kind == Observation::Kind::kRadio && seen.frame.type == am::kJoin &&
                        seen.frame.src == am;
      return asks || is_report(seen);
    };
    const Observation* const next =
        whole ? nullptr : context_.next(now_us, Context::kHeldLongUs, is_next);
    if (next != nullptr && is_report(*next)) {
      watch.comes_us = next->place.time_us;
      continue;
    }
    sink.set_due(watch, false);
    const auto owes = [](const SinkHypothesis& h) { return !h.unknown && h.owes_report; };
    if (!std::all_of(watch.set.begin(), watch.set.end(), owes)) continue;
    context_.report("J6-REPORT"_rule,
                    room && !may_be_lost(sink, watch) &&
                            !context_.who.damaged(watch.admitted.time_us, now_us) &&
                            context_.line_recorded(sink.device, watch.admitted.time_us)
                        ? context_.own_absent_on_line(sink.device, Severity::kFail)
                        : Severity::kInconclusive,
                    watch.admitted, sink.device,
                    {"The ack_join of mote " + number(am) +
                         (whole ? " was received (by the sink's log)"
                                : " was received (the link acknowledged it)") +
                         ", and no serial_joined followed within " +
                         ms_text(context_.response_us(sink.device)) +
                         (whole ? "." : ", though the sink sent other frames later."),
                     "One serial_joined for the new member.",
                     {}});
  }
}

// Returns whether the last ack_join may have found the incoming buffer full (decision 122): of more
// messages than go into it, or of what waits since longer ago than crowded() looks back.
bool Announcements::may_be_lost(const SinkWatch& sink, const PairWatch& watch) const {
  const std::int64_t at_us = watch.admitted.time_us;
  const std::int64_t before_us = at_us - 2 * context_.response_us(sink.device);
  constexpr auto kRadio = machine::Link::kRadio;
  return context_.crowded(sink.device, at_us) ||
         (context_.busy(sink.device, before_us, before_us, kRadio) &&
          context_.busy(sink.device, at_us, at_us, kRadio));
}

// Reports an ack_join that by a log the sink surely got and its application never heard of.
void Announcements::unannounced(const SinkWatch& sink, std::uint16_t mote_am,
                                const PairWatch& watch, std::int64_t end_us) {
  const Device& device = context_.device(sink.device);
  if (!device.application || !watch.admitted.timed() || watch.set.empty()) return;
  // It is told by what comes from the radio, whatever the serial line is busy with.
  const std::int64_t due_us =
      context_.due_us(sink.device, watch.admitted_us, machine::Link::kRadio);
  if (end_us <= due_us || !context_.tells<machine::MoteJoined>(sink.device, due_us)) return;
  if (watch.is_ahead(context_.options.skew_us)) return;  // Perhaps that was the event.
  const auto owes = [](const SinkHypothesis& h) { return !h.unknown && h.owes_notice; };
  if (!std::all_of(watch.set.begin(), watch.set.end(), owes)) return;
  context_.report("J6-ADD"_rule,
                  may_be_lost(sink, watch) ? Severity::kInconclusive : Severity::kFail,
                  watch.admitted, sink.device,
                  {std::string("The sink ") + (device.hearing ? "was given" : "surely received") +
                       " the ack_join of mote " + number(mote_am) +
                       " with the number that it had answered, and does not list the mote: no "
                       "moteJoined followed within " +
                       ms_text(context_.response_us(sink.device)) + ".",
                   "moteJoined for the new member.",
                   {}});
}

void Announcements::ends(std::uint16_t sink_device, std::int64_t now_us) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink == nullptr) return;
  for (const auto& [am, watch] : sink->motes) unannounced(*sink, am, watch, now_us);
}

void Announcements::forgets(std::uint16_t sink_device, std::uint16_t mote_am, std::int64_t now_us) {
  SinkWatch* const sink = joins_.find(sink_device);
  if (sink != nullptr) unannounced(*sink, mote_am, joins_.pair(*sink, mote_am), now_us);
}

void Announcements::finish() {
  for (SinkWatch& sink : joins_.all()) {
    const std::int64_t end_us = context_.end_us(sink.device);
    overdue_reports(sink, end_us);
    for (const auto& [am, watch] : sink.motes) unannounced(sink, am, watch, end_us);
  }
}

}  // namespace rubric::check
