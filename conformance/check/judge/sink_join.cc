#include "conformance/check/judge/sink_join.h"

#include <algorithm>

#include "conformance/check/links.h"

namespace rubric::check {

using machine::Admission;
using machine::JoinSink;

namespace {

bool surely_lists(const PairWatch& pair) {
  const auto lists = [](const SinkHypothesis& h) { return !h.unknown && h.member; };
  return !pair.set.empty() && std::ranges::all_of(pair.set, lists);
}

}  // namespace

SinkJoins::SinkJoins(Context& context) : context_(context) {
  for (std::size_t i = 0; i < context.who.devices.size(); ++i) {
    const Device& device = context.who.devices[i];
    const auto index = static_cast<std::uint16_t>(i);
    if (device.role != machine::Role::kSink) continue;
    SinkWatch sink;
    sink.device = index;
    sink.island = device.set_later ? kNoIsland : device.island;
    sinks_.push_back(std::move(sink));
  }
}

SinkWatch* SinkJoins::find(std::uint16_t sink) {
  for (SinkWatch& watch : sinks_) {
    if (watch.device == sink) return &watch;
  }
  return nullptr;
}

std::uint16_t SinkJoins::island(std::uint16_t sink) const {
  for (const SinkWatch& watch : sinks_) {
    if (watch.device == sink) return watch.island;
  }
  return kNoIsland;
}

bool SinkJoins::is_own(std::uint16_t sink, machine::Address address, std::int64_t now_us) const {
  if (address.devid != context_.device(sink).am) return false;
  const auto its = [&](const SinkWatch& watch) {
    // If the first island seen of a sink is one that it is told, nobody knows which it had before.
    const bool unknown =
        watch.first_set_us >= 0 && now_us <= context_.due_us(sink, watch.first_set_us);
    const bool former = unknown || (watch.island_set && address.pid == watch.former_island &&
                                    now_us <= context_.due_us(sink, watch.island_set_us));
    return watch.device == sink && (address.pid == watch.island || former);
  };
  return std::ranges::any_of(sinks_, its);
}

PairWatch& SinkJoins::pair(SinkWatch& sink, std::uint16_t mote_am) {
  PairWatch& watch = sink.motes[mote_am];
  if (watch.set.empty()) {
    SinkHypothesis start;
    start.unknown = !context_.options.start_cold;
    watch.set.push_back(start);
  }
  return watch;
}

void SinkJoins::begin_life(std::uint16_t sink, std::int64_t since_us) {
  SinkWatch* const watch = find(sink);
  if (watch == nullptr) return;
  std::erase_if(watch->motes, [&](const auto& one) {
    const PairWatch& mote = one.second;  // The new life may have heard what came since then.
    return !(mote.asked && mote.request.time_us >= since_us) &&
           !(mote.ack.frame != 0 && mote.ack.time_us >= since_us);
  });
  for (auto& [am, mote] : watch->motes) mote.know_nothing();
  watch->has_clock = false;
  watch->debts = 0;
  watch->serial_off = false;
  watch->reported_us = -1;
  const Device& device = context_.device(sink);
  if (!device.hearing) return;  // A capture does not show with which island it begins.
  watch->island = device.island;
  watch->former_island = watch->start_island = kNoIsland;
  watch->ignored = watch->unheard = -1;
  watch->island_set = false;
}

void SinkJoins::set_island(std::uint16_t sink, std::uint16_t island, const Place& at, bool sure) {
  SinkWatch* const watch = find(sink);
  if (watch == nullptr) return;
  const bool seen =
      watch->island_shown_us >= 0 || (watch->island != island && watch->island != kNoIsland);
  if (!watch->island_set && !seen) watch->first_set_us = at.time_us;
  if (watch->island == island) {  // It may forget its members, or keep them (decision 123).
    for (auto& [am, pair] : watch->motes) {
      SinkHypothesis forgotten;
      if (surely_lists(pair)) pair.set.insert(pair.set.begin(), forgotten);
    }
    watch->island_set = true;
    watch->island_set_us = at.time_us;
    watch->island_sure = watch->island_sure || sure;
    return;
  }
  if (!watch->island_set) watch->start_island = watch->island;
  watch->island_set = true;
  watch->island_sure = sure;
  watch->former_island = watch->island;
  watch->island_set_us = at.time_us;
  watch->island = island;
  if (listed(*watch) > 0) {
    context_.report("N9-MEMBERS"_rule, Severity::kNote, at, sink,
                    {"The island becomes " + number(island) +
                         "; members that are cut off: " + number(listed(*watch)) + ".",
                     "The sink forgets its members.",
                     {}});
  }
  for (auto& [am, pair] : watch->motes) {
    pair.cut_off = surely_lists(pair);
    may_forget(*watch, pair, at);
    watch->set_due(pair, false);
  }
  watch->reported_us = -1;
}

// Takes a sink of another island to keep what it knows of the mote, or to forget its members, or
// with them the requests that it stored, or to start anew (decision 123). What it owes by then may
// still be on its way.
void SinkJoins::may_forget(SinkWatch& sink, PairWatch& pair, const Place& at) {
  next_.clear();
  for (SinkHypothesis h : pair.set) {
    next_.push_back(h);
    if (h.unknown) continue;
    h.member.reset();
    next_.push_back(h);
    h.pending.reset();
    next_.push_back(h);
    next_.push_back(SinkHypothesis{});
  }
  keep(sink, pair, next_, at);
}

void SinkJoins::missed_island(std::uint16_t sink, std::uint16_t island) {
  if (SinkWatch* const watch = find(sink)) watch->unheard = island;
}

void SinkJoins::configured(std::uint16_t sink, const machine::Frame& frame) {
  SinkWatch* const watch = find(sink);
  const auto config = rubicon::ConfigView::parse(frame.payload);
  if (watch != nullptr && config) watch->ignored = config->value();
}

ReqId SinkJoins::wrong_island(const SinkWatch& sink, std::uint16_t other, ReqId otherwise) {
  if (sink.unheard == other) return "N10-OFF"_rule;
  if (sink.ignored == other) return "N9-OTHER"_rule;
  return sink.island_set ? "N9-SET"_rule : otherwise;
}

// Returns whether the sink may hear it. A sink with a log of what it was given hears nothing else.
bool SinkJoins::hears(const Device& device, const Observation& seen, bool sure) const {
  if (!device.known) return false;
  const bool all = seen.frame.dest == machine::kAmBroadcast;  // Wrong, but it may be heard.
  if (device.hearing) return sure && !all;
  return !seen.received && (all || seen.frame.dest == device.am);
}

void SinkJoins::may_have_replied(const Observation& seen, const Reply& reply) {
  for (SinkWatch& sink : sinks_) {
    const Device& device = context_.device(sink.device);
    if (device.am != seen.frame.src || sink.island != reply.island || device.hearing) continue;
    PairWatch& mote = pair(sink, seen.frame.dest);
    sink.set_due(mote, false);
    mote.know_nothing();
  }
}

void SinkJoins::doubt(std::uint16_t sink, PairWatch& watch, const Place& now) const {
  const std::uint32_t gone_after = context_.profile(sink).gone_after_ticks;
  if (gone_after == 0 || context_.device(sink).application) return;
  if (now.time_us - watch.ack.time_us < machine::us_of(gone_after)) return;
  SinkHypothesis unknown;
  unknown.unknown = true;
  watch.set.push_back(unknown);
}

void SinkJoins::request(std::uint16_t mote_device, const Observation& seen, const Request& request,
                        std::uint16_t surely_received_by) {
  const std::uint16_t am = seen.frame.src;
  if (mote_device != kNobody && context_.device(mote_device).known) {
    Unanswered& unanswered = unanswered_[am];
    close_unanswered(am, unanswered);
    unanswered = {seen.place, request.seq_num, true, false, kNobody};
  }
  for (SinkWatch& sink : sinks_) {
    const Device& device = context_.device(sink.device);
    const bool given = surely_received_by == sink.device;
    if (!hears(device, seen, given)) continue;
    PairWatch& watch = pair(sink, am);
    // It may be the link's copy of one that was answered before, and not captured.
    const bool copy = !device.hearing && watch.answered && watch.answered_seq == request.seq_num &&
                      seen.place.time_us - watch.answered_us <= kLinkRepeatUs;
    const bool sure = given && !copy;
    doubt(sink.device, watch, seen.place);
    // With a full list it may be silent.
    const bool full = listed(sink) >= context_.profile(sink.device).members_max;
    watch.request_listed = sure && std::all_of(watch.set.begin(), watch.set.end(),
                                               [](const auto& h) { return h.member.has_value(); });
    const bool answers_listed = !context_.profile(sink.device).listed_ignored;
    next_.clear();
    for (const SinkHypothesis& h : watch.set) {
      SinkHypothesis heard = h;
      JoinSink list = list_of(heard);
      context_.actions.clear();
      const bool answers = machine::hear_request(
          list, context_.join_context(sink.device, sink.island, seen.place.time_us), am,
          request.seq_num, request.descriptor, context_.actions);
      take_list(list, heard);
      // Where a listed mote may be answered, it may be ignored, too.
      if (!sure || h.unknown || full || (answers_listed && h.member)) next_.push_back(h);
      if (answers) {
        heard.unknown = false;
        if (heard.owed == heard.owed_seq.size()) {
          std::copy(heard.owed_seq.begin() + 1, heard.owed_seq.end(), heard.owed_seq.begin());
          --heard.owed;
          heard.owes_older = true;
        }
        heard.owed_seq[heard.owed++] = request.seq_num;
        next_.push_back(heard);
      } else if (sure && !h.unknown) {
        next_.push_back(heard);
      }
    }
    watch.request = seen.place;
    watch.request_seq = request.seq_num;
    watch.asked = true;
    keep(sink, watch, next_, seen.place);
  }
}

void SinkJoins::answered(std::uint16_t mote_am, std::uint16_t seq_num) {
  const auto found = unanswered_.find(mote_am);
  if (found != unanswered_.end() && found->second.seq_num == seq_num) found->second.open = false;
}

// Returns whether the sink's log, whose frames a capture replaced, lacks the request until it is
// sent again.
bool SinkJoins::missed(std::uint16_t sink, std::uint16_t mote_am,
                       const Unanswered& unanswered) const {
  if (sink >= context_.run.nodes.size() || !context_.run.nodes[sink].requests) return false;
  const GivenRequests& given = *context_.run.nodes[sink].requests;
  const std::int64_t asked_us = unanswered.request.time_us;
  const std::int64_t skew_us = context_.options.skew_us;
  if (asked_us < given.from_us - skew_us || asked_us > given.to_us) return false;
  const std::int64_t period_us = context_.join_period_us(context_.slowest_mote(mote_am));
  return std::ranges::none_of(given.all, [&](const GivenRequests::Request& one) {
    const std::int64_t after_us = one.time_us - asked_us;
    return one.mote_am == mote_am && one.seq_num == unanswered.seq_num && after_us > -skew_us &&
           after_us < period_us / 2;
  });
}

void SinkJoins::close_unanswered(std::uint16_t mote_am, Unanswered& unanswered) {
  if (!unanswered.open) return;
  unanswered.open = false;
  // If all sinks have logs, these show who received it.
  const auto shows = [&](const SinkWatch& sink) {
    return context_.device(sink.device).hearing || missed(sink.device, mote_am, unanswered);
  };
  if (!sinks_.empty() && std::all_of(sinks_.begin(), sinks_.end(), shows)) return;
  for (SinkWatch& sink : sinks_) {  // A sink that lists it, or is full, is right not to answer.
    const PairWatch& watch = pair(sink, mote_am);
    if (listed(sink) >= context_.profile(sink.device).members_max) return;
    const auto may_list = [](const SinkHypothesis& h) { return h.member.has_value(); };
    if (std::any_of(watch.set.begin(), watch.set.end(), may_list)) return;
  }
  const ReqId rule = unanswered.overtaken ? "J9-INTERLEAVE"_rule : "J3-REPLY"_rule;
  const std::uint16_t sink = unanswered.sink != kNobody ? unanswered.sink : context_.only_sink;
  context_.report(
      rule, Severity::kInconclusive, unanswered.request, sink,
      {"No reply to the join_request " + number(unanswered.seq_num) + " of mote " +
           number(mote_am) +
           (unanswered.overtaken ? ", although a later one of another mote was answered" : "") +
           "; nothing proves that a sink received it.",
       "A join_reply, if the request arrived.",
       {}});
}

// Returns whether by some hypothesis the sink owes the mote a reply with that number.
bool SinkJoins::owes(SinkWatch& sink, std::uint16_t mote_am, std::uint16_t seq_num) {
  const auto found = sink.motes.find(mote_am);
  return found != sink.motes.end() &&
         std::ranges::any_of(found->second.set, [seq_num](const SinkHypothesis& h) {
           const auto end = h.owed_seq.begin() + h.owed;
           return std::find(h.owed_seq.begin(), end, seq_num) != end;
         });
}

std::uint16_t SinkJoins::reply(std::uint16_t sink_device, const Observation& seen,
                               const Reply& reply) {
  SinkWatch* const sink = find(sink_device);
  if (sink == nullptr) return seen.frame.dest;
  const bool astray =
      seen.frame.dest != reply.mote &&
      (seen.frame.dest == machine::kAmBroadcast ||
       (owes(*sink, reply.mote, reply.seq_num) && !owes(*sink, seen.frame.dest, reply.seq_num)));
  const std::uint16_t am = astray ? reply.mote : seen.frame.dest;
  if (astray) {
    context_.report(
        "J3-DEST"_rule,
        context_.without_mote(seen.frame.dest, context_.run.start_us, seen.place.time_us),
        seen.place, sink_device,
        {"The join_reply to request " + number(reply.seq_num) + " of mote " + number(am) +
             " goes to AM address " + number(seen.frame.dest) + ".",
         "AM address " + number(am) + ", which asked.",
         {}});
  }
  PairWatch& watch = pair(*sink, am);
  for (auto& [other, unanswered] : unanswered_) {
    if (other == am) {
      unanswered.open = unanswered.open && unanswered.seq_num != reply.seq_num;
    } else if (unanswered.open && watch.asked &&
               unanswered.request.time_us <= watch.request.time_us) {
      unanswered.overtaken = true;
      unanswered.sink = sink_device;
    }
  }
  judge_clock(*sink, seen, reply);
  if (sink->island == kNoIsland && !machine::is_reserved(reply.island)) sink->island = reply.island;
  if (machine::is_reserved(reply.island)) {
    context_.report("N9-OTHER"_rule, Severity::kFail, seen.place, sink_device,
                    {"join_reply offers island " + number(reply.island) + ", which is reserved.",
                     "The island of the sink.",
                     {}});
  } else if (reply.island != sink->island &&
             !keeps_former(*sink, reply.island, seen.place, watch.request.time_us)) {
    const ReqId rule = wrong_island(*sink, reply.island, "J3-ADDRESS"_rule);
    // SET_ISLAND_ID may have escaped, or found the line switched off.
    const Severity severity = sink->island_sure ? Severity::kFail : Severity::kInconclusive;
    context_.report(rule, context_.on_line(sink_device, severity), seen.place, sink_device,
                    {"join_reply offers island " + number(reply.island) + ".",
                     "Island " + number(sink->island) + ", the sink's.",
                     {}});
  } else if (reply.mote != am) {
    context_.report(
        "J3-ADDRESS"_rule, Severity::kFail, seen.place, sink_device,
        {"join_reply to mote " + number(am) + " gives it the devid " + number(reply.mote) + ".",
         "mote_addr " + number(am) + ", the TinyOS id of the mote that asked.",
         {}});
  } else {
    context_.findings.kept("J3-ADDRESS"_rule);
  }
  sink->island_sure = sink->island_sure || reply.island == sink->island;
  next_.clear();
  for (const SinkHypothesis& h : watch.set) {
    SinkHypothesis next = h;
    if (h.unknown) {
      next.unknown = false;
      next.pending = Admission{am, reply.seq_num, {}};
      next.owes_older = watch.asked && reply.seq_num != watch.request_seq;
      next_.push_back(next);
      if (!next.owes_older) continue;
      // Or it answers an older request late, and has the last one in mind.
      next.pending->seq_num = watch.request_seq;
      next.owed = 1;
      next.owed_seq[0] = watch.request_seq;
      next_.push_back(next);
      continue;
    }
    const auto end = next.owed_seq.begin() + next.owed;
    const auto owed = std::find(next.owed_seq.begin(), end, reply.seq_num);
    if (owed != end) {
      std::copy(owed + 1, end, owed);
      next.owed_seq[--next.owed] = 0;
      next.owes_older = next.owes_older && next.owed > 0;
    } else if (!next.owes_older) {
      continue;
    }
    next_.push_back(next);
  }
  if (next_.empty()) {
    refuse_reply(*sink, watch, seen, reply);
  } else {
    context_.findings.kept("J3-SEQ"_rule);
    context_.findings.kept("J3-ONCE"_rule);
    context_.findings.kept("J3-DEST"_rule);
    // A reply that was granted while there was room may wait for the air until the list is full.
    const std::size_t members =
        listed(*sink, watch.asked ? watch.request.time_us : seen.place.time_us);
    const bool new_mote =
        std::none_of(next_.begin(), next_.end(), [](const SinkHypothesis& h) { return h.member; });
    if (new_mote && members >= context_.profile(sink_device).members_max) {
      context_.report("J3-FULL"_rule, Severity::kWeak, seen.place, sink_device,
                      {"join_reply to a new mote while " + number(members) + " are members.",
                       "No reply when the list is full.",
                       {}});
    }
    keep(*sink, watch, next_, seen.place);
  }
  watch.answered = true;
  watch.answered_us = seen.place.time_us;
  watch.cut_off = false;
  watch.answered_seq = reply.seq_num;
  return am;
}

void SinkJoins::refuse_reply(SinkWatch& sink, PairWatch& watch, const Observation& seen,
                             const Reply& reply) {
  const std::uint16_t am = seen.frame.dest;
  const SinkHypothesis& h = watch.set.back();
  // The request that it answers may lie before the capture, by the timer of the mote.
  const std::int64_t before_us =
      watch.request.time_us - context_.join_period_us(context_.slowest_mote(am));
  const bool covered = watch.asked && before_us >= context_.run.start_us;
  const std::int64_t since = covered ? watch.request.time_us : context_.run.start_us - 1;
  Said said;
  for (auto it = watch.set.rbegin(); it != watch.set.rend(); ++it) {
    said.hypotheses.push_back({sentence(*it),
                               it->owed > 0
                                   ? "A join_reply with number " + number(it->owed_seq[0]) + "."
                                   : "No join_reply.",
                               "join_reply with number " + number(reply.seq_num) + "."});
  }
  ReqId rule = "J3-ONCE"_rule;
  Severity severity = context_.without_mote(am, since, seen.place.time_us);
  if (!watch.asked && !context_.options.start_cold) severity = Severity::kInconclusive;
  const auto asks_this = [&](const auto& entry) {
    return entry.first != am && entry.second.asked && entry.second.request_seq == reply.seq_num;
  };
  if (reply.mote != am && std::any_of(sink.motes.begin(), sink.motes.end(), asks_this) &&
      reply.seq_num != watch.request_seq) {
    rule = "J3-DEST"_rule;  // Two motes may use the same number, and one request have escaped.
    said.text = "join_reply to AM address " + number(am) +
                " with the number of another mote's request (" + number(reply.seq_num) + ").";
    said.expected = "A reply to the AM address that asked.";
  } else if (h.member && watch.asked && reply.seq_num == watch.request_seq &&
             (watch.request_listed || watch.answered_seq != reply.seq_num ||
              watch.request.time_us > watch.ack.time_us)) {
    rule = "J2-LISTED"_rule;
    // A capture does not show that a sink lost its power, and with it its list; nor one without all
    // of its line that its island was set, perhaps to the same one (decision 123).
    severity = watch.ack.time_us < sink.behind_us
                   ? Severity::kInconclusive
                   : context_.unless_given(sink.device, watch.ack.time_us);
    said.text = "join_reply to mote " + number(am) + ", which the sink lists as a member.";
    said.expected = "No answer to a mote that is listed.";
  } else if (watch.asked && reply.seq_num != watch.request_seq) {
    rule = "J3-SEQ"_rule;
    said.text = "join_reply with number " + number(reply.seq_num) + " to mote " + number(am) +
                ", whose request has " + number(watch.request_seq) + ".";
    said.expected = "Number " + number(watch.request_seq) + ".";
  } else {
    said.text = watch.asked ? "A second join_reply to one join_request (number " +
                                  number(reply.seq_num) + ", mote " + number(am) + ")."
                            : "join_reply to mote " + number(am) + ", which has not asked.";
    said.expected = "At most one join_reply for each join_request.";
  }
  if (rule == "J3-ONCE"_rule && answers_copy(sink.device, watch, seen, reply)) {
    severity = std::min(severity, Severity::kInconclusive);
  }
  context_.report(rule, severity, seen.place, sink.device, std::move(said));
  SinkHypothesis next = h;
  // Its stored request is unknown now, unless this was the answer to it, with a wrong number.
  next.unknown = rule != "J3-SEQ"_rule || severity != Severity::kFail;
  if (!next.unknown) {
    next.pending = Admission{am, watch.request_seq, {}};
    unanswered_[am].open = false;
  }
  next.owed = 0;
  next.owes_older = false;
  watch.set.assign(1, next);
}

void SinkJoins::ack_join(std::uint16_t, const Observation& seen, const AckJoin& ack,
                         std::uint16_t surely_received_by) {
  for (SinkWatch& sink : sinks_) {
    const Device& device = context_.device(sink.device);
    const bool sure = surely_received_by == sink.device;
    if (!hears(device, seen, sure)) continue;
    PairWatch& watch = pair(sink, ack.src.devid);
    next_.clear();
    // With a list that may be full of others it may ignore the mote, and owe nothing.
    const bool full = others(sink, watch) >= context_.profile(sink.device).members_max;
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
          !stranger &&
          machine::hear_ack_join(
              list, context_.join_context(sink.device, sink.island, seen.place.time_us), ack.dest,
              ack.src, ack.seq_num, ack.descriptor, context_.actions);
      take_list(list, heard);
      if (stranger) ignored = "J6-SENDER"_rule;
      if (!admits && !context_.actions.all().empty()) {
        ignored = context_.actions.all()[0].requirement;
      }
      if (!sure || !admits || h.unknown || full) next_.push_back(h);
      all_admit = all_admit && admits && !h.unknown && !full;
      if (!admits) continue;
      admitted = true;
      heard.unknown = false;
      heard.owes_report = device.shows_line();
      heard.owes_notice = device.application;
      next_.push_back(heard);
    }
    watch.ack = seen.place;
    if (admitted) {
      watch.admitted = seen.place;
      watch.admitted_us = seen.place.time_us + air_us(seen);
    }
    watch.ignored_ack = admitted ? ReqId::kNone : ignored;
    if (ack.dest.pid == sink.island) watch.own_ack_us = seen.place.time_us;
    const bool waits = sink.serial_off && !device.whole;
    if (sure && all_admit && device.shows_line() && !waits) sink.set_due(watch, true);
    keep(sink, watch, next_, seen.place);
  }
}

void SinkJoins::finish() {
  std::vector<std::uint16_t> open;
  for (auto& [am, unanswered] : unanswered_) {
    if (unanswered.open) open.push_back(am);
  }
  std::sort(open.begin(), open.end());
  for (const std::uint16_t am : open) close_unanswered(am, unanswered_[am]);
}

void SinkJoins::keep(SinkWatch& sink, PairWatch& watch, std::vector<SinkHypothesis>& next,
                     const Place& at) {
  watch.set.clear();
  for (const SinkHypothesis& h : next) {
    if (std::find(watch.set.begin(), watch.set.end(), h) == watch.set.end()) {
      watch.set.push_back(h);
    }
  }
  if (watch.set.size() <= kSetMax) return;
  context_.report("J3-REPLY"_rule, Severity::kInconclusive, at, sink.device,
                  {"More than " + number(kSetMax) + " explanations of what the sink knows.",
                   "Fewer; this mote's joins are not judged at this sink.",
                   {}});
  SinkHypothesis unknown;
  unknown.unknown = true;
  watch.set.assign(1, unknown);
}

std::size_t SinkJoins::listed(const SinkWatch& sink, std::int64_t since_us) const {
  std::size_t count = 0;
  for (const auto& [am, watch] : sink.motes) {
    count += surely_lists(watch) && watch.admitted_us <= since_us ? 1 : 0;
  }
  return count;
}

// Returns how many other motes the sink may list.
std::size_t SinkJoins::others(const SinkWatch& sink, const PairWatch& pair) {
  std::size_t count = 0;
  for (const auto& [am, watch] : sink.motes) {
    const auto may = [](const SinkHypothesis& h) { return h.unknown || h.member; };
    count += &watch != &pair && std::ranges::any_of(watch.set, may) ? 1 : 0;
  }
  return count;
}

std::string SinkJoins::sentence(const SinkHypothesis& h) {
  if (h.unknown) return "The sink may have listed the mote before.";
  std::string text = h.member ? "The sink lists the mote" : "The sink does not list the mote";
  if (h.owed > 0)
    text += ", heard its request and owes a reply to " + number(h.owed_seq[0]);
  else if (h.pending)
    text += ", has answered " + number(h.pending->seq_num);
  if (h.owes_report) text += ", owes serial_joined";
  return text + ".";
}

}  // namespace rubric::check
