#include "conformance/script/watch.h"

#include <algorithm>
#include <memory>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "conformance/machine/join.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/transport.h"
#include "conformance/runner/subject_target.h"
#include "conformance/trace/trace.h"

namespace rubric::script {
namespace {

using explorer::Property;
using machine::Address;
using machine::Frame;
using machine::Link;
using machine::Role;
using machine::State;
using machine::Transmit;
namespace am = machine::am;
using Phase = machine::JoinMote::Phase;

// Whether the node's lines bring it this frame at all.
bool reaches(const State& state, const Frame& frame) {
  const Role role = state.config.role;
  if (frame.link == Link::kPeis) return role == Role::kBaseStation && frame.dest == state.island;
  if (frame.link == Link::kSerial) return role != Role::kMote && state.serial.on;
  const bool addressed = frame.dest == state.config.id || frame.dest == machine::kAmBroadcast;
  return role != Role::kBaseStation && state.radio.on && addressed;
}

std::size_t waiting_replies(const State& state, std::uint16_t dest) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < state.radio.out.size(); ++i) {
    const machine::Buffered& one = state.radio.out[i];
    count += one.type == am::kJoinReply && one.dest == dest;
  }
  return count;
}

// serial_joined that wait for the line. Others may send what looks like one.
int waiting_reports(const State& state) {
  int count = 0;
  for (std::size_t i = 0; i < state.serial.out.size(); ++i) {
    count += state.serial.out[i].requirement == "J6-REPORT"_rule;
  }
  return count;
}

bool is_broadcast(Address dest) {
  return dest.pid == machine::kBroadcastPid || dest.devid == machine::kBroadcastDevid;
}

}  // namespace

void Watched::breaks(Property property, Ticks now) {
  if (broken_) return;
  const explorer::PropertyInfo& info = explorer::info(property);
  broken_ = Broken{info.name, info.sentence, {}, now};
  for (const ReqId rule : info.requirements) {
    if (rule != ReqId::kNone) broken_->requirements.push_back(rule);
  }
}

void Watched::start(const machine::Config& config) {
  config_ = config;
  state_ = machine::start(config);
  history_ = {};
  broken_.reset();
  last_ = 0;
  steps_ = 0;
}

runner::DueTimers Watched::timers() const {
  return steps_ < kTimedStepsMax ? machine::timers(state_) : runner::DueTimers{};
}

void Watched::step(Ticks now, const machine::Event& event, machine::Actions& actions) {
  ++steps_;
  const State before = state_;
  step_(state_, now, event, actions);
  const Seen seen{before, event, actions, state_, handled(before, event), now};
  same_again(before, seen);
  check_labels(seen);
  check_frames(seen);
  check_bounds(seen);
  begins(seen);
  for (const Frame& frame : seen.handled) frame_handled(seen, frame);
  for (const machine::Action& action : actions.all()) {
    if (action.what == machine::Action::What::kTransmit) {
      const Transmit& transmit = actions.transmit_of(action);
      if (config_.role == Role::kMote) mote_sends(seen, transmit);
      if (config_.role == Role::kSink) sink_sends(seen, transmit, action.requirement);
    } else if (action.what == machine::Action::What::kNotify) {
      told(seen, actions.notice_of(action));
    }
  }
  for (const Frame& frame : seen.handled) ack_handled(seen, frame);
  for (const Frame& frame : seen.handled) ack_join_handled(seen, frame);
  ends(seen);
  last_ = now;
}

std::vector<Frame> Watched::handled(const State& before, const machine::Event& event) const {
  if (before.off) return {};
  if (const auto* heard = std::get_if<machine::Heard>(&event)) {
    const bool now = !before.app_busy || heard->frame.link == Link::kPeis;
    if (now && reaches(before, heard->frame)) return {heard->frame};
  }
  const auto* app = std::get_if<machine::AppBusy>(&event);
  if (!app || app->busy) return {};
  std::vector<Frame> out;
  std::size_t radio = 0;
  std::size_t serial = 0;
  for (std::size_t i = 0; i < before.waiting.size(); ++i) {
    const Link link = before.waiting[i];
    const machine::Buffered& one =
        link == Link::kRadio ? before.radio.in[radio++] : before.serial.in[serial++];
    out.push_back({link, one.dest, one.src, one.type, one.bytes()});
  }
  return out;
}

void Watched::begins(const Seen& seen) {
  if (std::holds_alternative<machine::Reboot>(seen.event) ||
      std::holds_alternative<machine::PowerOff>(seen.event)) {
    history_ = {};
    return;
  }
  const auto* called = std::get_if<machine::Called>(&seen.event);
  const bool joins = called && std::holds_alternative<machine::JoinIsland>(called->call);
  if (!joins || seen.before.off) return;
  History& h = history_;
  ++h.open_calls;
  if (h.view || h.open_calls > 1 || config_.role != Role::kMote) return;
  h.opened = seen.now;
  h.asked = false;
  h.requests = 0;
  h.offers.clear();
  h.chosen.reset();
}

void Watched::request_handled(const Seen& seen, const Frame& frame) {
  const auto request = rubicon::JoinRequestView::parse(frame.payload);
  const std::uint16_t from = frame.src;
  if (!request || machine::is_reserved(from) || from == config_.id) return;
  History& h = history_;
  ++h.heard_requests[from];
  const machine::Profile& profile = config_.profile;
  const bool listed = machine::find_member(seen.before.sink, from) != nullptr;
  if (listed && profile.listed_ignored) {
    std::size_t replies = waiting_replies(seen.after, from);
    for (const Transmit& one : seen.actions.transmits()) {
      replies += one.type == am::kJoinReply && one.dest == from;
    }
    const bool alone = seen.handled.size() == 1;
    if (alone && replies > waiting_replies(seen.before, from)) {
      breaks(Property::kListedSilent, seen.now);
    }
  } else if (listed || seen.before.sink.members.size() < profile.members_max) {
    h.stored[from] = request->seq_num();
    h.stored_too_many |= h.stored.size() > machine::kPendingMax;
  }
}

void Watched::frame_handled(const Seen& seen, const Frame& frame) {
  const Role role = config_.role;
  History& h = history_;
  if (frame.link != Link::kRadio) return;
  if (role == Role::kMote && frame.type == am::kJoinReply) {
    const auto reply = rubicon::JoinReplyView::parse(frame.payload);
    if (reply && h.asked && h.open_calls > 0 && reply->seq_num() == h.present_seq) {
      h.offers.insert(reply->island_addr());
    }
  } else if (role == Role::kSink && frame.type == am::kJoin) {
    request_handled(seen, frame);
  } else if (role == Role::kSink && frame.type == am::kAckJoin) {
    const auto ack = rubicon::AckJoinView::parse(frame.payload);
    if (ack) h.acked.insert(static_cast<std::uint16_t>(ack->src().devid()));
  }
}

void Watched::mote_sends(const Seen& seen, const Transmit& transmit) {
  History& h = history_;
  if (transmit.type == am::kJoin) {
    const auto request = rubicon::JoinRequestView::parse(transmit.bytes());
    const bool too_many = ++h.requests > config_.profile.join_requests_max;
    if (!request || h.open_calls == 0 || h.view || too_many) {
      return breaks(Property::kRequestsBounded, seen.now);
    }
    if (h.asked && h.present_seq != request->seq_num()) h.offers.clear();
    h.asked = true;
    h.present_seq = request->seq_num();
  } else if (transmit.type == am::kAckJoin) {
    const auto ack = rubicon::AckJoinView::parse(transmit.bytes());
    const auto pid = ack ? static_cast<std::uint16_t>(ack->dest().pid()) : std::uint16_t{0};
    const bool right = ack && h.asked && ack->seq_num() == h.present_seq && h.offers.contains(pid);
    if (!right) breaks(Property::kAckRightSeq, seen.now);
    if (h.chosen.value_or(pid) != pid) breaks(Property::kOneIsland, seen.now);
    h.chosen = pid;
  } else if (transmit.type == am::kNet && !h.view) {
    breaks(Property::kMembersOnly, seen.now);
  }
}

void Watched::sink_sends(const Seen& seen, const Transmit& transmit, ReqId rule) {
  if (rule == "J6-REPORT"_rule) --history_.reports_owed;
  if (transmit.type == am::kJoinReply && --history_.heard_requests[transmit.dest] < 0) {
    breaks(Property::kListedSilent, seen.now);
  }
}

void Watched::told_joined(const Seen& seen, const machine::Joined& joined) {
  History& h = history_;
  if (--h.open_calls < 0) breaks(Property::kOneTerminal, seen.now);
  if (!joined.success) return;
  const bool own = joined.address.devid == config_.id;
  if (!own || !h.offers.contains(joined.address.pid)) {
    breaks(Property::kJoinedAfterReply, seen.now);
  }
  if (h.view) breaks(Property::kOneIsland, seen.now);
  h.view = joined.address;
}

void Watched::told_received(const Seen& seen, const machine::Received& received) {
  const bool mote = config_.role == Role::kMote;
  const bool sink = config_.role == Role::kSink;
  for (const Frame& frame : seen.handled) {
    const auto message = rubicon::NetMsgView::parse(frame.payload);
    if (frame.type != am::kNet || !message) continue;
    const Bytes body = message->payload();
    if (machine::address_of(message->src()) != received.src || body[1] != received.app_id) continue;
    if (!equal(body.from(2), received.data)) continue;
    const Address dest = machine::address_of(message->dest());
    // Every island may be delivered (decision 114), and a sink trusts its base station (126).
    const bool trusted = sink && frame.link == Link::kSerial;
    const bool own = mote ? history_.view && dest.pid == history_.view->pid
                          : dest.pid == seen.after.island || dest.pid == seen.before.island;
    if (own || trusted || dest.pid == machine::kBroadcastPid) return;
  }
  breaks(Property::kOwnIslandOnly, seen.now);
}

void Watched::told(const Seen& seen, const machine::Notice& notice) {
  History& h = history_;
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) {
    told_joined(seen, *joined);
  } else if (const auto* mote = std::get_if<machine::MoteJoined>(&notice)) {
    if (h.stored.erase(mote->address.devid) == 0 && !h.stored_too_many) {
      breaks(Property::kOneReport, seen.now);
    }
    ++h.reports_owed;
  } else if (const auto* sent = std::get_if<machine::SendResult>(&notice)) {
    const auto& send = std::get<machine::Send>(std::get<machine::Called>(seen.event).call);
    if (!send.reliable || sent->seq_num == machine::kNoSeq) return;
    Address dest = send.dest;
    if (dest.pid == machine::kLocalPid) dest.pid = machine::own_address(seen.after).pid;
    h.sends.push_back({sent->seq_num, send.app_id, dest, {}});
  } else if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) {
    const auto gone = std::find_if(h.sends.begin(), h.sends.end(), [&](const History::Sent& one) {
      return one.seq_num == ack->seq_num && one.app_id == ack->app_id;
    });
    if (gone == h.sends.end()) return breaks(Property::kReliableEnds, seen.now);
    h.sends.erase(gone);
  } else if (const auto* received = std::get_if<machine::Received>(&notice)) {
    told_received(seen, *received);
  }
}

// An ack that was good before the step has ended its message.
void Watched::ack_handled(const Seen& seen, const Frame& frame) {
  const auto message = rubicon::NetMsgView::parse(frame.payload);
  const bool ack = frame.type == am::kNet && message &&
                   message->payload()[0] == machine::component::kRubiconAck;
  // A new island may have come before it.
  if (!ack || (seen.handled.size() > 1 && seen.after.island != seen.before.island)) return;
  if (machine::address_of(message->dest()) != machine::own_address(seen.before)) return;
  const Address from = machine::address_of(message->src());
  const std::uint8_t app_id = message->payload()[1];
  const std::int32_t seq_num = machine::acked_seq_num(message->payload().from(2));
  for (const History::Sent& one : history_.sends) {  // Those that are still open.
    if (one.seq_num != seq_num || one.app_id != app_id || one.dest != from) continue;
    if (!is_broadcast(one.dest)) breaks(Property::kAckCounts, seen.now);
  }
}

// An ack_join that was good before the step has made a member.
void Watched::ack_join_handled(const Seen& seen, const Frame& frame) {
  const State& before = seen.before;
  if (before.config.role != Role::kSink || frame.link != Link::kRadio) return;
  const auto ack = rubicon::AckJoinView::parse(frame.payload);
  if (frame.type != am::kAckJoin || !ack) return;
  const Address src{before.island, frame.src};
  const Address dest{before.island, before.config.id};
  if (machine::address_of(ack->src()) != src || machine::address_of(ack->dest()) != dest) return;
  const auto stored = history_.stored.find(frame.src);
  const bool good = stored != history_.stored.end() && stored->second == ack->seq_num();
  const bool room = before.sink.members.size() + seen.handled.size() <=
                    config_.profile.members_max;
  if (!good || !room || history_.stored_too_many || seen.after.island != before.island) return;
  // Where several frames were handled, a later request may have come behind it.
  if (seen.handled.size() == 1) breaks(Property::kAdmitted, seen.now);
}

void Watched::overdue(Ticks now) {
  if (steps_ >= kTimedStepsMax) return;
  const machine::Profile& profile = config_.profile;
  const Ticks timeout = profile.ack_timeout_ticks;
  for (const History::Sent& one : history_.sends) {
    const bool late = one.left && now > *one.left + timeout;
    if (late && timeout != 0) breaks(Property::kReliableEnds, now);
  }
  // Each of its requests may have had to wait for the radio for nearly a period.
  const Ticks longest = 2 * profile.join_period_ticks * (profile.join_requests_max + 1U);
  const bool calling = history_.open_calls > 0 && profile.join_fail_signalled;
  if (calling && now > history_.opened + longest) breaks(Property::kOneTerminal, now);
}

void Watched::mote_ends(const Seen& seen) {
  History& h = history_;
  const machine::JoinMote& join = seen.after.join;
  if (!config_.profile.join_fail_signalled && join.phase == Phase::kOutside) h.open_calls = 0;
  const int calls = join.phase == Phase::kJoining ? 1 : 0;
  if (h.open_calls != calls) breaks(Property::kOneTerminal, seen.now);
  const Address own = machine::own_address(seen.after);
  if (h.view && own != *h.view) breaks(Property::kOneIsland, seen.now);
}

void Watched::sink_ends(const Seen& seen) {
  History& h = history_;
  const State& after = seen.after;
  if (after.island != seen.before.island) {
    h.stored.clear();
    h.acked.clear();
    h.stored_too_many = false;
    h.reports_owed = waiting_reports(after);  // The others are cut off.
  }
  const machine::Interface<2>& line = after.serial;
  const bool idle = line.on && !line.sending && !line.taken && line.out.empty();
  const bool once = config_.profile.listed_ignored;  // Else a mote's last report may be enough.
  if (h.reports_owed < 0 || (once && idle && h.reports_owed > 0)) {
    breaks(Property::kOneReport, seen.now);
  }
  for (const machine::Admission& member : after.sink.members) {
    if (!h.acked.contains(member.devid)) breaks(Property::kListedAcked, seen.now);
  }
}

void Watched::ends(const Seen& seen) {
  History& h = history_;
  for (History::Sent& open : h.sends) {
    if (!open.left && !waits_for_line(seen.after, open.seq_num)) open.left = seen.now;
  }
  if (config_.role == Role::kMote) mote_ends(seen);
  if (config_.role == Role::kSink) sink_ends(seen);
  // Without a timeout the oldest may be given up.
  const bool counted = config_.profile.ack_timeout_ticks != 0;
  if (counted && h.sends.size() != seen.after.awaited.size()) {
    breaks(Property::kReliableEnds, seen.now);
  }
  overdue(seen.now);
}

void Watched::finish(Ticks now) { overdue(now); }

bool waits_for_line(const State& state, std::uint16_t seq_num) {
  for (std::size_t i = 0; i < state.radio.out.size(); ++i) {
    if (state.radio.out[i].awaited == seq_num) return true;
  }
  for (std::size_t i = 0; i < state.serial.out.size(); ++i) {
    if (state.serial.out[i].awaited == seq_num) return true;
  }
  return false;
}

std::string Broken::text() const {
  std::string rules;
  for (const ReqId rule : requirements) {
    rules += (rules.empty() ? " (" : " ") + std::string(trace::requirement_text(rule));
  }
  if (!rules.empty()) rules += ')';
  return name + " at " + std::to_string(time) + rules + ": " + sentence;
}

std::optional<Broken> watch(const Script& script, flaws::StepFunction step) {
  auto subject = std::make_unique<Watched>(step);
  Watched& watched = *subject;
  runner::SubjectTarget target(std::move(subject));
  play(script, target);
  watched.finish(script.length());
  return watched.broken();
}

}  // namespace rubric::script
