#include "conformance/explore/history.h"

#include <algorithm>
#include <utility>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/app_msg.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/explore/options.h"
#include "conformance/machine/join.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/transport.h"

namespace rubric::explore {
namespace {

using machine::Address;
using machine::Frame;
using machine::Link;
using machine::Role;
using machine::State;
using machine::Transmit;
namespace am = machine::am;
using App = rubicon::AppMsgLayout;

// Whether the node's lines bring it this frame at all.
bool reaches(const State& state, const Frame& frame) {
  const Role role = state.config.role;
  if (frame.link == Link::kPeis) return role == Role::kBaseStation && frame.dest == state.island;
  if (frame.link == Link::kSerial) return role != Role::kMote && state.serial.on;
  const bool addressed = frame.dest == state.config.id || frame.dest == machine::kAmBroadcast;
  return role != Role::kBaseStation && state.radio.on && addressed;
}

bool is_broadcast(Address dest) {
  return dest.pid == machine::kBroadcastPid || dest.devid == machine::kBroadcastDevid;
}

// serial_joined that wait for the line. Others may send what looks like one.
int waiting_reports(const State& state) {
  int count = 0;
  for (std::size_t i = 0; i < state.serial.out.size(); ++i) {
    count += state.serial.out[i].requirement == "J6-REPORT"_rule;
  }
  return count;
}

class Observer {
 public:
  Observer(History& history, const Observed& step, const std::vector<Frame>& handled, Noted& noted)
      : history_(history), step_(step), handled_(handled), noted_(noted) {}

  void run() {
    begins();
    for (const Frame& frame : handled_) frame_handled(frame);
    for (const machine::Action& action : step_.actions.all()) {
      if (action.what == machine::Action::What::kTransmit) {
        sends(step_.actions.transmit_of(action), action.requirement);
      } else if (action.what == machine::Action::What::kNotify) {
        told(step_.actions.notice_of(action));
      }
    }
    for (const Frame& frame : handled_) ack_handled(frame);
    for (const Frame& frame : handled_) ack_join_handled(frame);
    ends();
  }

 private:
  void breaks(Property property) { noted_.violated |= bit(property); }
  void reach(Goal goal) { noted_.goals |= bit(goal); }
  Role role() const { return step_.config.role; }
  const machine::Profile& profile() const { return step_.config.profile; }

  // What the event itself says, before its consequences.
  void begins() {
    History& h = history_;
    if (std::holds_alternative<machine::Reboot>(step_.event) ||
        std::holds_alternative<machine::PowerOff>(step_.event)) {
      History fresh{.acked = std::move(h.acked)};
      h = std::move(fresh);
      return;
    }
    const auto* called = std::get_if<machine::Called>(&step_.event);
    const bool joins = called && std::holds_alternative<machine::JoinIsland>(called->call);
    if (!joins || step_.before.off) return;
    ++h.open_calls;
    // A member's call fails at once, and the call before stays the present one.
    if (h.view || h.open_calls > 1 || role() != Role::kMote) return;
    h.opened = step_.now;
    h.asked = false;
    h.requests = 0;
    h.present_seq = 0;
    h.offers.clear();
    h.chosen.clear();
  }

  void frame_handled(const Frame& frame) {
    if (frame.link != Link::kRadio) return;
    if (role() == Role::kMote && frame.type == am::kJoinReply) reply_handled(frame);
    if (role() == Role::kSink && frame.type == am::kJoin) request_handled(frame);
  }

  void reply_handled(const Frame& frame) {
    const auto reply = rubicon::JoinReplyView::parse(frame.payload);
    if (!reply) return;
    History& h = history_;
    const std::uint16_t island = reply->island_addr();
    const bool present = h.asked && reply->seq_num() == h.present_seq;
    if (h.open_calls > 0 && present) h.offers.insert(island);
    if (h.open_calls > 0 && h.asked && !present) reach(Goal::kStaleReply);
    if (h.open_calls == 0 && h.view && present && island != h.view->pid) reach(Goal::kSecondOffer);
  }

  // Whether a sink has to look at this request.
  bool is_request(const Frame& frame) const {
    return frame.link == Link::kRadio && frame.type == am::kJoin &&
           rubicon::JoinRequestView::parse(frame.payload) && !machine::is_reserved(frame.src) &&
           frame.src != step_.config.id;
  }
  bool ignores(const Frame& request) const {
    return profile().listed_ignored && machine::find_member(step_.before.sink, request.src);
  }

  void request_handled(const Frame& frame) {
    const auto& sink = step_.before.sink;
    if (!is_request(frame)) return;
    // Who is answered against the rules may join none the less.
    if (ignores(frame) && new_replies()[frame.src] <= 0) return;
    const bool listed = machine::find_member(sink, frame.src) != nullptr;
    if (!listed && sink.members.size() >= profile().members_max) return;
    const auto request = rubicon::JoinRequestView::parse(frame.payload);
    std::map<std::uint16_t, Answered>& answered = history_.answered;
    answered[frame.src] = {true, request->seq_num()};
    const auto armed = std::count_if(answered.begin(), answered.end(),
                                     [](const auto& one) { return one.second.armed; });
    if (static_cast<std::size_t>(armed) > machine::kPendingMax) history_.overwritten = true;
  }

  void sends(const Transmit& transmit, ReqId rule) {
    if (role() == Role::kMote) mote_sends(transmit);
    // Applications may send what looks like a report, but not by this rule.
    if (role() == Role::kSink && rule == "J6-REPORT"_rule && is_report(transmit)) {
      --history_.owed_reports;
    }
  }

  static bool is_report(const Transmit& transmit) {
    const auto message = rubicon::NetMsgView::parse(transmit.bytes());
    return transmit.link == Link::kSerial && transmit.type == am::kNet && message &&
           rubicon::SerialJoinedView::parse(message->payload().from(App::PayloadAt::kAt));
  }

  void mote_sends(const Transmit& transmit) {
    if (transmit.type == am::kJoin) mote_asks(transmit.bytes());
    if (transmit.type == am::kAckJoin) mote_acks(transmit.bytes());
    if (transmit.type == am::kNet && !history_.view) breaks(Property::kMembersOnly);
  }

  void mote_asks(Bytes payload) {
    const auto request = rubicon::JoinRequestView::parse(payload);
    History& h = history_;
    if (!request || h.open_calls == 0 || h.view) return breaks(Property::kRequestsBounded);
    if (h.asked && h.present_seq != request->seq_num()) h.offers.clear();
    h.asked = true;
    h.present_seq = request->seq_num();
    // One too many is enough to know: a mote that asks for ever has few states.
    if (h.requests <= profile().join_requests_max) ++h.requests;
    if (h.requests > 1) reach(Goal::kRetried);
    if (h.requests > profile().join_requests_max) breaks(Property::kRequestsBounded);
  }

  void mote_acks(Bytes payload) {
    const auto ack = rubicon::AckJoinView::parse(payload);
    if (!ack) return breaks(Property::kAckRightSeq);
    History& h = history_;
    const auto island = static_cast<std::uint16_t>(ack->dest().pid());
    if (!h.asked || ack->seq_num() != h.present_seq || !h.offers.contains(island)) {
      breaks(Property::kAckRightSeq);
    }
    h.chosen.insert(island);
    if (h.chosen.size() > 1) breaks(Property::kOneIsland);
    h.acked.insert(island);
  }

  void told(const machine::Notice& notice) {
    if (const auto* joined = std::get_if<machine::Joined>(&notice)) told_joined(*joined);
    if (const auto* mote = std::get_if<machine::MoteJoined>(&notice)) told_mote_joined(*mote);
    if (const auto* sent = std::get_if<machine::SendResult>(&notice)) told_sent(*sent);
    if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) told_acked(*ack);
    if (const auto* received = std::get_if<machine::Received>(&notice)) told_received(*received);
  }

  void told_joined(const machine::Joined& joined) {
    History& h = history_;
    if (h.open_calls == 0) {
      breaks(Property::kOneTerminal);
    } else {
      --h.open_calls;
    }
    const int requests = std::exchange(h.requests, 0);
    if (!joined.success) {
      if (h.view) reach(Goal::kJoinedAgain);
      if (!h.view && requests == profile().join_requests_max) reach(Goal::kFailed);
      return;
    }
    const std::uint16_t island = joined.address.pid;
    const bool own = joined.address.devid == step_.config.id;
    if (!own || !h.offers.contains(island)) breaks(Property::kJoinedAfterReply);
    if (h.view) breaks(Property::kOneIsland);
    h.view = joined.address;
    // What else it heard matters no more.
    std::erase_if(h.offers, [&](std::uint16_t one) { return one != island; });
    if (island == kFirstIsland) reach(Goal::kJoinedFirst);
    if (island == kFirstIsland + 1) reach(Goal::kJoinedSecond);
  }

  void told_mote_joined(const machine::MoteJoined& joined) {
    const auto answered = history_.answered.find(joined.address.devid);
    const bool armed = answered != history_.answered.end() && answered->second.armed;
    if (!armed && !history_.overwritten) breaks(Property::kOneReport);
    if (armed) answered->second.armed = false;
    ++history_.owed_reports;
    reach(Goal::kListed);
  }

  void told_sent(const machine::SendResult& sent) {
    const auto& send = std::get<machine::Send>(std::get<machine::Called>(step_.event).call);
    if (!send.reliable || sent.seq_num == machine::kNoSeq) return;
    Address dest = send.dest;
    if (dest.pid == machine::kLocalPid) dest.pid = machine::own_address(step_.after).pid;
    history_.sends.push_back({sent.seq_num, send.app_id, dest, {}});
  }

  void told_acked(const machine::AckReceived& ack) {
    reach(ack.success ? Goal::kAckedMessage : Goal::kTimedOut);
    std::vector<OpenSend>& sends = history_.sends;
    const auto gone = std::find_if(sends.begin(), sends.end(), [&](const OpenSend& one) {
      return one.seq_num == ack.seq_num && one.app_id == ack.app_id;
    });
    if (gone == sends.end()) return breaks(Property::kReliableEnds);
    sends.erase(gone);
  }

  void told_received(const machine::Received& received) {
    reach(Goal::kDelivered);
    for (const Frame& frame : handled_) {
      const auto message = rubicon::NetMsgView::parse(frame.payload);
      if (frame.type != am::kNet || !message) continue;
      const Bytes body = message->payload();
      const auto app_id = static_cast<std::uint8_t>(App::AppIdAt::load(body.data()));
      const bool same = machine::address_of(message->src()) == received.src &&
                        app_id == received.app_id &&
                        equal(body.from(App::PayloadAt::kAt), received.data);
      if (same && may_deliver(frame, machine::address_of(message->dest()).pid)) return;
    }
    breaks(Property::kOwnIslandOnly);
  }

  // Every island may be delivered (decision 114), and a sink trusts its base station (126).
  bool may_deliver(const Frame& frame, std::uint16_t pid) const {
    if (pid == machine::kBroadcastPid) return true;
    if (role() == Role::kMote) return history_.view && pid == history_.view->pid;
    const bool trusted = role() == Role::kSink && frame.link == Link::kSerial;
    return trusted || pid == step_.after.island || pid == step_.before.island;
  }

  // An ack that was good before the step has ended its message.
  void ack_handled(const Frame& frame) {
    const auto message = rubicon::NetMsgView::parse(frame.payload);
    const Bytes payload = message ? message->payload() : Bytes();
    const bool ack = frame.type == am::kNet && message &&
                     App::TransIdAt::load(payload.data()) == rubicon::Component::kRubiconAck;
    // A new island may have come before it.
    const bool moved = handled_.size() > 1 && step_.after.island != step_.before.island;
    if (!ack || moved) return;
    if (machine::address_of(message->dest()) != machine::own_address(step_.before)) return;
    const Address from = machine::address_of(message->src());
    const auto app_id = static_cast<std::uint8_t>(App::AppIdAt::load(payload.data()));
    const std::int32_t seq_num = machine::acked_seq_num(payload.from(App::PayloadAt::kAt));
    for (const OpenSend& one : history_.sends) {  // Those that are still open.
      if (one.seq_num != seq_num || one.app_id != app_id || one.dest != from) continue;
      if (!is_broadcast(one.dest)) breaks(Property::kAckCounts);
    }
  }

  // The number was the right one before the step, so the mote is a member after it.
  void ack_join_handled(const Frame& frame) {
    if (role() != Role::kSink || frame.link != Link::kRadio || frame.type != am::kAckJoin) return;
    const auto ack = rubicon::AckJoinView::parse(frame.payload);
    if (!ack) return;
    const std::uint16_t island = step_.before.island;
    const Address src{island, frame.src};
    const Address dest{island, step_.config.id};
    if (machine::address_of(ack->src()) != src || machine::address_of(ack->dest()) != dest) return;
    const bool was_listed = machine::find_member(step_.before.sink, frame.src) != nullptr;
    const bool listed = machine::find_member(step_.after.sink, frame.src) != nullptr;
    if (listed && was_listed) reach(Goal::kRepeatedAck);
    const auto answered = history_.answered.find(frame.src);
    const bool good =
        answered != history_.answered.end() && answered->second.seq_num == ack->seq_num();
    const bool room =
        step_.before.sink.members.size() + handled_.size() <= profile().members_max || was_listed;
    if (!good || !room || history_.overwritten || step_.after.island != island) return;
    // Where several frames were handled, a later request may have come after it.
    const bool told = !answered->second.armed;
    if (handled_.size() == 1 && !(listed && told)) breaks(Property::kAdmitted);
  }

  void ends() {
    History& h = history_;
    for (OpenSend& open : h.sends) {
      if (!open.left && !waits_for_line(step_.after, open.seq_num)) open.left = step_.now;
    }
    if (role() == Role::kMote) mote_ends();
    if (role() == Role::kSink) sink_ends();
    // Without a timeout the oldest may be given up.
    const bool counted = profile().ack_timeout_ticks != 0;
    if (counted && h.sends.size() != step_.after.awaited.size()) breaks(Property::kReliableEnds);
    const auto* heard = std::get_if<machine::Heard>(&step_.event);
    if (heard != nullptr && heard->frame.type == am::kNet && step_.actions.notices().empty() &&
        step_.actions.transmits().empty()) {
      reach(Goal::kForeignIgnored);
    }
    check_bounds();
  }

  void mote_ends() {
    History& h = history_;
    // Calls of this profile may end without a word.
    const bool outside = step_.after.join.phase == machine::JoinMote::Phase::kOutside;
    if (!profile().join_fail_signalled && outside) h.open_calls = 0;
    if (h.view && machine::own_address(step_.after) != *h.view) breaks(Property::kOneIsland);
  }

  void sink_ends() {
    History& h = history_;
    const State& after = step_.after;
    if (after.island != step_.before.island) {
      h.answered.clear();
      h.overwritten = h.reports_lost = false;
      h.owed_reports = waiting_reports(after);  // The others are cut off.
    }
    check_replies();
    check_members();
    // A mote that joins again and again may be reported once. Who is listed does not.
    h.reports_lost |= !profile().listed_ignored && after.sink.unreported.full();
    const machine::Interface<2>& line = after.serial;
    const bool idle = line.on && !line.sending && !line.taken && line.out.empty();
    if (idle && h.reports_lost) {
      h.reports_lost = false;
      h.owed_reports = 0;
    }
    if (h.owed_reports < 0 || (idle && h.owed_reports > 0)) breaks(Property::kOneReport);
    if (after.sink.pending.size() > 1) reach(Goal::kInterleaved);
  }

  // By mote: the replies that were sent or put into the buffer in this step.
  std::map<std::uint16_t, int> new_replies() const {
    std::map<std::uint16_t, int> out;
    const auto count = [&](const State& state, int sign) {
      for (std::size_t i = 0; i < state.radio.out.size(); ++i) {
        const machine::Buffered& one = state.radio.out[i];
        if (one.type == am::kJoinReply) out[one.dest] += sign;
      }
    };
    count(step_.after, 1);
    count(step_.before, -1);
    for (const Transmit& one : step_.actions.transmits()) {
      if (one.type == am::kJoinReply) ++out[one.dest];
    }
    return out;
  }

  // Each is for a request that was handled in the same step.
  void check_replies() {
    std::map<std::uint16_t, int> unasked = new_replies();
    // Where several frames were handled, one before a request may have listed or forgotten the
    // mote.
    const bool alone = handled_.size() == 1;
    for (const Frame& frame : handled_) {
      if (is_request(frame) && !(alone && ignores(frame))) --unasked[frame.src];
    }
    for (const auto& [mote, replies] : unasked) {
      if (replies > 0) breaks(Property::kListedSilent);
    }
    for (const Transmit& one : step_.actions.transmits()) {
      const bool reply = one.type == am::kJoinReply;
      if (reply && !rubicon::JoinReplyView::parse(one.bytes())) breaks(Property::kListedSilent);
    }
  }

  void check_members() {
    for (const machine::Admission& member : step_.after.sink.members) {
      if (machine::find_member(step_.before.sink, member.devid) != nullptr) continue;
      const bool acked = std::any_of(handled_.begin(), handled_.end(), [&](const Frame& frame) {
        const auto ack = rubicon::AckJoinView::parse(frame.payload);
        return frame.link == Link::kRadio && frame.type == am::kAckJoin && ack &&
               static_cast<std::uint16_t>(ack->src().devid()) == member.devid;
      });
      if (!acked) breaks(Property::kListedAcked);
    }
  }

  // Lists and buffers after the step.
  void check_bounds() {
    const State& s = step_.after;
    const std::size_t waiting = s.radio.in.size() + s.serial.in.size();
    const bool lists = s.sink.members.size() <= profile().members_max &&
                       s.sink.pending.size() <= machine::kPendingMax &&
                       s.sink.unreported.size() <= machine::kMembersMax &&
                       s.awaited.size() <= machine::kAwaitedMax &&
                       s.synaptic.out.size() <= profile().channels_max &&
                       s.synaptic.in.size() <= profile().channels_max;
    const bool buffers =
        s.radio.out.size() <= s.radio.out.room() && s.serial.out.size() <= s.serial.out.room() &&
        s.radio.in.size() <= s.radio.in.room() && s.serial.in.size() <= s.serial.in.room() &&
        s.waiting.size() == waiting && (s.app_busy || waiting == 0);
    const bool once = std::all_of(s.sink.members.begin(), s.sink.members.end(),
                                  [&](const machine::Admission& member) {
                                    return machine::find_member(s.sink, member.devid) == &member;
                                  });
    if (!lists || !buffers || !once) breaks(Property::kQueuesBounded);
  }

  History& history_;
  const Observed& step_;
  const std::vector<Frame>& handled_;
  Noted& noted_;
};

}  // namespace

std::vector<Frame> handled_frames(const State& before, const machine::Event& event) {
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

bool waits_for_line(const State& state, std::uint16_t seq_num) {
  const auto waits = [&](const auto& line) {
    for (std::size_t i = 0; i < line.out.size(); ++i) {
      if (line.out[i].awaited == seq_num) return true;
    }
    return false;
  };
  return waits(state.radio) || waits(state.serial);
}

void observe(History& history, const Observed& step, const std::vector<Frame>& handled,
             Noted& noted) {
  Observer(history, step, handled, noted).run();
}

}  // namespace rubric::explore
