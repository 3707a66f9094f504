// SinkJoins: ack_join at a sink, and the announcements that follow. See sink_join.h.
#include <algorithm>

#include "conformance/check/judge/sink_join.h"
#include "conformance/check/links.h"

namespace rubric::check {
namespace {

constexpr std::int64_t kFrameUs = 12'000;  // A whole message on a serial line of 115,200 baud.

}  // namespace

using machine::Admission;
using machine::JoinSink;

void SinkJoins::ack_join(std::uint16_t, const Observation& seen, const AckJoin& ack,
                         std::uint16_t surely_received_by) {
  for (SinkWatch& sink : sinks_) {
    const Device& device = context_.device(sink.device);
    const bool sure = surely_received_by == sink.device;
    if (!hears(device, seen, sure)) continue;
    PairWatch& watch = pair(sink, ack.src.devid);
    next_.clear();
    bool admitted = false;
    bool all_admit = true;
    ReqId ignored = ReqId::kNone;
    for (const SinkHypothesis& h : watch.set) {
      SinkHypothesis heard = h;
      const Admission accepted{ack.src.devid, ack.seq_num, ack.descriptor};
      // Only its later acts show what a sink stored before the capture, or for a request that
      // nobody saw.
      const bool open = h.unknown || (h.pending && h.pending->descriptor == machine::Descriptor{});
      if (open && heard.pending) heard.pending->descriptor = ack.descriptor;
      if (open && !heard.pending) heard.pending = accepted;
      JoinSink list = list_of(heard);
      context_.actions.clear();
      const bool stranger = ack.dest.devid != device.am || ack.src.devid != seen.frame.src ||
                            ack.src.pid != ack.dest.pid;
      const bool admits =
          !stranger && machine::hear_ack_join(
                           list, context_.join_context(device.am, sink.island, seen.place.time_us),
                           ack.dest, ack.src, ack.seq_num, ack.descriptor, context_.actions);
      take_list(list, heard);
      if (stranger) ignored = "J6-SENDER"_rule;
      if (!admits && !context_.actions.all().empty()) {
        ignored = context_.actions.all()[0].requirement;
      }
      if (!sure || !admits || h.unknown) next_.push_back(h);
      all_admit = all_admit && admits && !h.unknown;
      if (!admits) continue;
      admitted = true;
      heard.unknown = false;
      heard.owes_report = device.shows_line();
      heard.owes_notice = device.application;
      next_.push_back(heard);
    }
    watch.ack = seen.place;
    watch.ack_whole_us = seen.place.time_us + air_us(seen);
    watch.ignored_ack = admitted ? ReqId::kNone : ignored;
    if (sure && all_admit && !watch.report_due && device.shows_line() && !sink.serial_off) {
      watch.report_due = true;
      ++sink.debts;
    }
    keep(sink, watch, next_, seen.place);
  }
}

void SinkJoins::report(std::uint16_t sink_device, const Observation& seen, const Net& net,
                       const SerialJoined& joined) {
  SinkWatch* const sink = find(sink_device);
  if (sink == nullptr) return;
  if (sink->island == 0) sink->island = joined.address.pid;
  const machine::Address to{joined.address.pid, machine::kNullDevid};
  if (net.src != joined.address || net.dest != to || net.reliable != 0) {
    context_.report(
        "J6-CONTENT"_rule, Severity::kFail, seen.place, sink_device,
        {"serial_joined of " + text_of(joined.address) + " in a net_msg from " + text_of(net.src) +
             " to " + text_of(net.dest) + ", reliable " + number(net.reliable) + ".",
         "From " + text_of(joined.address) + " to " + text_of(to) + ", reliable 0.",
         {}});
  }
  announce(*sink, seen.place, joined.address, joined.descriptor, false);
}

void SinkJoins::told(std::uint16_t sink_device, const Observation& seen,
                     const machine::MoteJoined& joined) {
  SinkWatch* const sink = find(sink_device);
  if (sink != nullptr) announce(*sink, seen.place, joined.address, joined.descriptor, true);
}

// Judges serial_joined, or moteJoined (`notice`), of a mote.
void SinkJoins::announce(SinkWatch& sink, const Place& at, machine::Address address,
                         const machine::Descriptor& descriptor, bool notice) {
  PairWatch& watch = pair(sink, address.devid);
  const ReqId content = notice ? "J6-ADD"_rule : "J6-CONTENT"_rule;
  if (address.pid != sink.island) {
    const ReqId rule = sink.island_set ? "N9-SET"_rule : content;
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
    if (!stored || *stored != descriptor) stored = h.member->descriptor;
    next_.push_back(next);
  }
  if (watch.report_due && !notice) {
    watch.report_due = false;
    --sink.debts;
  }
  if (next_.empty()) {
    refuse_report(sink, watch, at, address.devid, notice);
    return;
  }
  if (!notice && watch.ack.frame != 0) {
    sink.reported_us = std::max(sink.reported_us, watch.ack.time_us);
  }
  if (stored && *stored != descriptor) {
    // A sink with one memory for all motes would announce the descriptor of another mote's request.
    context_.report(
        content, Severity::kFail, at, sink.device,
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
  keep(sink, watch, next_, at);
  const std::size_t members = listed(sink);
  if (members > context_.profile().members_max) {
    context_.report("J3-FULL"_rule, Severity::kWeak, at, sink.device,
                    {"Member " + number(members) + " of the sink is announced.",
                     "At most " + number(context_.profile().members_max) + " members.",
                     {}});
  }
}

void SinkJoins::refuse_report(SinkWatch& sink, PairWatch& watch, const Place& at,
                              std::uint16_t mote_am, bool notice) {
  const SinkHypothesis& h = watch.set.back();
  Said said;
  for (auto it = watch.set.rbegin(); it != watch.set.rend(); ++it) {
    said.hypotheses.push_back(
        {sentence(*it), "No announcement of this mote.", "The mote is announced as a new member."});
  }
  const std::string what = notice ? "moteJoined" : "serial_joined";
  ReqId rule = "J6-ADD"_rule;
  const bool has_ack = watch.ack.frame != 0;
  // The request to which the ack belongs may have escaped as well.
  std::int64_t since = context_.run.start_us;
  if (has_ack && watch.asked) since = std::min(watch.ack.time_us, watch.request.time_us);
  Severity severity = context_.without_mote(mote_am, since, at.time_us);
  if (!has_ack && !context_.options.start_cold) severity = Severity::kInconclusive;
  if (h.member) {
    rule = "J6-REPEAT"_rule;
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
    said.text = what + " of mote " + number(mote_am) + ", whose only ack_join had " +
                (rule == "J6-SEQ"_rule ? "a number that was not its request's."
                                       : "another island as its destination.");
    said.expected = "That ack_join is ignored.";
  } else {
    said.text = what + " of mote " + number(mote_am) + ", which has sent no ack_join to this sink.";
    said.expected = what + " only after an ack_join with the number of the request.";
  }
  context_.report(rule, severity, at, sink.device, std::move(said));
  SinkHypothesis next = h;
  next.unknown = false;
  if (!next.member) next.member = Admission{mote_am, watch.request_seq, {}};
  watch.set.assign(1, next);
}

void SinkJoins::showed_life(std::uint16_t sink_device, std::int64_t now_us, bool on_serial) {
  SinkWatch* const sink = find(sink_device);
  if (sink == nullptr || !on_serial || now_us < 0) return;
  sink->behind = sink->serial_us >= 0 && now_us - sink->serial_us <= kFrameUs;
  sink->serial_us = now_us;
  if (sink->debts > 0) overdue_reports(*sink, kNotEnded);
}

void SinkJoins::serial_set(std::uint16_t sink_device, bool on) {
  SinkWatch* const sink = find(sink_device);
  if (sink == nullptr) return;
  sink->serial_off = !on;
  if (on) return;
  for (auto& [am, watch] : sink->motes) watch.report_due = false;
  sink->debts = 0;
}

void SinkJoins::overdue_reports(SinkWatch& sink, std::int64_t end_us) {
  std::vector<std::uint16_t> due;
  const bool end = end_us != kNotEnded;
  const bool whole = context_.device(sink.device).whole;
  const std::int64_t now_us = whole && end ? end_us : sink.serial_us;
  for (const auto& [am, watch] : sink.motes) {
    const std::int64_t due_us =
        context_.due_us(sink.device, watch.ack_whole_us) + (sink.behind ? kFrameUs : 0);
    if (watch.report_due && now_us > due_us) due.push_back(am);
  }
  std::sort(due.begin(), due.end(), [&](std::uint16_t a, std::uint16_t b) {
    return std::pair(sink.motes[a].ack.time_us, a) < std::pair(sink.motes[b].ack.time_us, b);
  });
  for (const std::uint16_t am : due) {
    PairWatch& watch = sink.motes[am];
    // Its list may be full of members from before the capture, unless it has taken a later one.
    const bool room = context_.options.start_cold || sink.reported_us > watch.ack.time_us;
    if (!room && !end) continue;
    watch.report_due = false;
    --sink.debts;
    const auto owes = [](const SinkHypothesis& h) { return !h.unknown && h.owes_report; };
    if (!std::all_of(watch.set.begin(), watch.set.end(), owes)) continue;
    // With a full list, even of members from before the capture, nothing is owed.
    if (listed(sink) >= context_.profile().members_max) continue;
    context_.report(
        "J6-REPORT"_rule,
        room && !context_.who.damaged(watch.ack.time_us, now_us)
            ? context_.on_line(sink.device, Severity::kFail)
            : Severity::kInconclusive,
        watch.ack, sink.device,
        {"The ack_join of mote " + number(am) +
             (whole ? " was received (by the sink's log)"
                    : " was received (the link acknowledged it)") +
             ", and no serial_joined followed within " + ms_text(context_.response_us()) +
             (whole ? "." : ", though the sink sent other frames later."),
         "One serial_joined for the new member.",
         {}});
  }
}

// Reports an ack_join that by a log the sink surely got and its application never heard of.
void SinkJoins::unannounced(const SinkWatch& sink, std::uint16_t mote_am, const PairWatch& watch,
                            std::int64_t end_us) {
  const Device& device = context_.device(sink.device);
  if (!device.hearing || !device.application || !watch.ack.timed() || watch.set.empty()) return;
  if (end_us <= watch.ack_whole_us + context_.response_us()) return;
  const auto owes = [](const SinkHypothesis& h) { return !h.unknown && h.owes_notice; };
  if (!std::all_of(watch.set.begin(), watch.set.end(), owes)) return;
  if (listed(sink) > context_.profile().members_max) return;
  context_.report("J6-ADD"_rule, Severity::kFail, watch.ack, sink.device,
                  {"The sink was given the ack_join of mote " + number(mote_am) +
                       " with the number that it had answered, and does not list the mote: no "
                       "moteJoined followed within " +
                       ms_text(context_.response_us()) + ".",
                   "moteJoined for the new member.",
                   {}});
}

void SinkJoins::finish(std::int64_t end_us) {
  for (SinkWatch& sink : sinks_) {
    overdue_reports(sink, end_us);
    for (const auto& [am, watch] : sink.motes) unannounced(sink, am, watch, end_us);
  }
  std::vector<std::uint16_t> open;
  for (auto& [am, unanswered] : unanswered_) {
    if (unanswered.open) open.push_back(am);
  }
  std::sort(open.begin(), open.end());
  for (const std::uint16_t am : open) close_unanswered(am, unanswered_[am]);
}

}  // namespace rubric::check
