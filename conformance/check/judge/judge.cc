#include "conformance/check/judge/judge.h"

#include <algorithm>

#include "conformance/check/judge/align_judge.h"
#include "conformance/check/judge/judge_pass.h"
#include "conformance/check/links.h"

namespace rubric::check {

using machine::Role;
using Kind = Observation::Kind;

Judge::Judge(const Run& run, const Options& options)
    : run_(run),
      who_(identify(run, options)),
      findings_(options.deployed, run.steps, trace::joined(options.stated, run.stated)),
      context_(run, options, who_, findings_),
      motes_((context_.look_up(), context_), who_.devices.size()),
      sinks_(context_),
      joins_(context_, motes_, sinks_, who_.devices.size()),
      forwarding_(context_),
      originals_(context_, who_.devices.size()),
      acks_(context_, who_.devices.size()),
      synaptic_(context_, who_.devices.size()),
      peis_(context_, who_.devices.size()),
      interfaces_(context_, who_.devices.size()) {}

Report Judge::judge() {
  Report report;
  for (std::uint32_t i = 0; i < run_.seen.size(); ++i) look(i);
  motes_.finish(run_.end_us);
  sinks_.finish(run_.end_us);
  joins_.finish(run_.end_us);
  originals_.finish(run_.end_us);
  forwarding_.finish(run_.end_us);
  acks_.finish();
  synaptic_.finish(run_.end_us);
  peis_.finish(run_.end_us);
  interfaces_.finish(run_.end_us);
  context_.finish();
  report.frames = frames_;
  report.facts = who_.facts;
  if (findings_.dropped() > 0) {
    report.facts.push_back(number(findings_.dropped()) + " more findings are not listed.");
  }
  report.exercised = findings_.exercised();
  report.findings = findings_.take();
  report.verdict = verdict_of(report.findings);
  return report;
}

bool Judge::is(std::uint16_t device, Role role) const {
  return device != kNobody && who_.devices[device].known && who_.devices[device].role == role;
}

void Judge::look(std::uint32_t index) {
  const Observation& seen = run_.seen[index];
  const Mark& mark = who_.marks[index];
  switch (seen.kind) {
    case Kind::kRadio:
      ++frames_;
      if (mark.repeat) return repeated(index, seen, mark);
      if (mark.new_life) begin_life(mark.device);
      radio(index, seen, mark);
      if (mark.device == kNobody) break;
      joins_.showed_life(mark.device, seen.place.time_us);
      if (is(mark.device, Role::kSink)) {
        forwarding_.showed_life(mark.device, seen.place.time_us);
      }
      if (!seen.received) interfaces_.sent(mark.device, seen);
      break;
    case Kind::kSerial:
      ++frames_;
      if (mark.repeat) return repeated(index, seen, mark);
      if (mark.device == kNobody) break;
      serial(index, seen, mark);
      if (!seen.received) interfaces_.sent(mark.device, seen);
      break;
    case Kind::kPeis:
      ++frames_;
      peis(seen, seen.received ? mark.receiver : mark.device);
      break;
    case Kind::kCall:
      if (mark.device != kNobody) called(seen, mark.device);
      break;
    case Kind::kNotice:
      if (mark.device != kNobody) told(seen, mark.device);
      break;
    case Kind::kReboot:
      if (mark.device == kNobody) break;
      joins_.rebooted(mark.device, seen.place.time_us);
      begin_life(mark.device);
      break;
    case Kind::kLinkAck:
    case Kind::kDamaged: break;
  }
}

void Judge::begin_life(std::uint16_t device) {
  if (is(device, Role::kMote)) motes_.begin_life(device);
  if (is(device, Role::kSink)) sinks_.begin_life(device);
  if (is(device, Role::kSink)) forwarding_.begin_life(device);
  originals_.begin_life(device);
  acks_.begin_life(device);
  synaptic_.begin_life(device);
  peis_.begin_life(device);
  joins_.begin_life(device);
  interfaces_.begin_life(device);
}

// Returns the sink that surely received a frame for the sinks' address.
std::uint16_t Judge::sure_sink(std::uint32_t index) const {
  if (who_.marks[index].receiver != kNobody) return who_.marks[index].receiver;
  return context_.only_sink != kNobody && link_acked(run_, index) ? context_.only_sink : kNobody;
}

void Judge::radio(std::uint32_t index, const Observation& seen, const Mark& mark) {
  if (mark.device != kNobody && !who_.devices[mark.device].known) {
    context_.report_stranger(seen, mark.device);
  }
  switch (seen.frame.type) {
    case am::kJoin: {
      Request request;
      if (!parse_request(seen.frame.payload, request)) return;
      if (is(mark.device, Role::kMote)) {
        motes_.request(mark.device, seen, request);
        joins_.asked(mark.device, index);
      }
      sinks_.request(mark.device, seen, request, sure_sink(index));
      joins_.surely_asked(sure_sink(index), index, request.seq_num);
      return;
    }
    case am::kJoinReply: {
      Reply reply;
      if (!parse_reply(seen.frame.payload, reply)) return;
      if (is(mark.device, Role::kSink)) {
        sinks_.reply(mark.device, seen, reply);
        joins_.answered(mark.device, seen.frame.dest, seen.place.time_us);
      }
      if (is(mark.device, Role::kMote)) {
        role_broken("J10-MOTE"_rule, "A mote sends a join_reply.", seen, mark.device);
      }
      replied(index, seen, mark, reply);
      return;
    }
    case am::kAckJoin: {
      AckJoin ack;
      if (!parse_ack_join(seen.frame.payload, ack)) return;
      if (is(mark.device, Role::kMote)) {
        motes_.ack_join(mark.device, seen, ack, link_acked(run_, index));
      }
      if (is(mark.device, Role::kSink)) {
        role_broken("J10-SINK"_rule, "A sink sends an ack_join.", seen, mark.device);
      }
      sinks_.ack_join(mark.device, seen, ack, sure_sink(index));
      return;
    }
    case am::kNet: {
      Net net;
      if (!parse_net(seen.frame.payload, net)) return;
      radio_net(index, seen, mark, net);
      return;
    }
    default: return;
  }
}

// Takes a join message that is known from its sender: a log's line that gives it to a node, or the
// link's repetition, which a node may have heard instead of the first or as well.
void Judge::joins_heard(std::uint32_t index, const Observation& seen, const Mark& mark) {
  Request request;
  Reply reply;
  AckJoin ack;
  if (seen.frame.type == am::kJoin && parse_request(seen.frame.payload, request)) {
    sinks_.request(kNobody, seen, request, mark.receiver);
    joins_.surely_asked(mark.receiver, index, request.seq_num);
  } else if (seen.frame.type == am::kJoinReply && parse_reply(seen.frame.payload, reply)) {
    replied(index, seen, mark, reply);
  } else if (seen.frame.type == am::kAckJoin && parse_ack_join(seen.frame.payload, ack)) {
    sinks_.ack_join(kNobody, seen, ack, mark.receiver);
  }
}

// Takes a reply. Motes whose log has what they were given hear nothing else.
void Judge::replied(std::uint32_t index, const Observation& seen, const Mark& mark,
                    const Reply& reply) {
  context_.for_motes(seen.frame.dest, [&](std::uint16_t mote) {
    const bool given = mark.receiver == mote;
    if (who_.devices[mote].hearing ? !given : seen.received) return;
    const bool only =
        context_.mote_of_am[seen.frame.dest] == mote && context_.next_of_am[mote] == kNobody;
    // The offer of a reserved island is to be ignored, as if it had not come (J4-ADDRESS).
    const bool heard = given || (only && link_acked(run_, index));
    const bool sure = heard && !machine::is_reserved(reply.island);
    motes_.reply(mote, seen, index, reply, sure);
    if (sure) joins_.surely_offered(mote, index, reply);
  });
}

void Judge::role_broken(ReqId rule, const char* what, const Observation& seen,
                        std::uint16_t device) {
  context_.report(rule, Severity::kFail, seen.place, device,
                  {what, "Join requests and their acks are for sinks, replies for motes.", {}});
}

void Judge::called(const Observation& seen, std::uint16_t device) {
  interfaces_.called(device, seen);
  if (const auto* join = std::get_if<machine::JoinIsland>(seen.call)) {
    if (is(device, Role::kMote)) motes_.called(device, seen, *join);
    return;
  }
  if (const auto* set = std::get_if<machine::SetInterface>(seen.call)) {
    if (set->link == machine::Link::kSerial) {
      forwarding_.serial_set(device, set->on);
      sinks_.serial_set(device, set->on);
    }
    if (set->link == machine::Link::kRadio) synaptic_.able(device, set->on, seen.place.time_us);
    if (set->link == machine::Link::kRadio) joins_.radio_set(device, set->on, seen.place.time_us);
    return;
  }
  const machine::Call& call = *seen.call;
  const bool other = std::holds_alternative<machine::Send>(call) ||
                     std::holds_alternative<machine::GetInterface>(call) ||
                     std::holds_alternative<machine::GetClock>(call) ||
                     std::holds_alternative<machine::SetIslandId>(call);
  if (other) return;  // The rest is for the channels.
  const Device& d = who_.devices[device];
  const machine::Address sinks_own{sinks_.island(device), d.am};
  const machine::Address motes_own = motes_.address(device).value_or(machine::Address{0, d.am});
  synaptic_.called(device, seen, d.role == Role::kSink ? sinks_own : motes_own);
}

void Judge::told(const Observation& seen, std::uint16_t device) {
  interfaces_.told(device, seen);
  if (const auto* joined = std::get_if<machine::Joined>(seen.notice)) {
    if (is(device, Role::kMote)) motes_.told(device, seen, *joined);
    if (joined->success) synaptic_.member(device, seen.place.time_us);
  } else if (const auto* mote_joined = std::get_if<machine::MoteJoined>(seen.notice)) {
    if (is(device, Role::kSink)) sinks_.told(device, seen, *mote_joined);
  } else if (const auto* received = std::get_if<machine::Received>(seen.notice)) {
    acks_.delivered(device, seen, *received);
  } else if (const auto* ack = std::get_if<machine::AckReceived>(seen.notice)) {
    originals_.told(device, seen, *ack);
  } else if (const auto* data = std::get_if<machine::SynDataReceived>(seen.notice)) {
    synaptic_.told(device, seen, *data);
  } else if (const auto* clock = std::get_if<machine::Clock>(seen.notice)) {
    if (is(device, Role::kMote)) joins_.clock_told(device, seen, clock->ms);
  }
}

Report judge(const Run& run, const Options& options) {
  if (!run.loose.empty() || !run.slack_taps.empty()) return judge_each_order(run, options);
  return run.steps.empty() ? Judge(run, options).judge() : judge_each_gap(run, options);
}

}  // namespace rubric::check
