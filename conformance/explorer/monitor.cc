#include "conformance/explorer/monitor.h"

#include <algorithm>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/join.h"
#include "conformance/machine/messages.h"
#include "conformance/machine/transport.h"

namespace rubric::explorer {
namespace {

using machine::Action;
using machine::Frame;
using machine::Link;
using machine::Role;
namespace am = machine::am;

using TransIdAt = Within<rubicon::NetMsgLayout::PayloadAt, rubicon::AppMsgLayout::TransIdAt>;
using BodyTypeAt =
    Within<rubicon::NetMsgLayout::PayloadAt,
           Within<rubicon::AppMsgLayout::PayloadAt, rubicon::SerialJoinedLayout::MsgTypeAt>>;

struct Watch {
  Monitor& monitor;
  const Observed& step;
  Noted& noted;

  void breaks(Property property) { noted.violated |= bit(property); }
  void reach(Goal goal) { noted.goals |= bit(goal); }
  bool is_mote() const { return step.before.config.role == Role::kMote; }
};

const Frame* heard_frame(const Watch& w) {
  const auto* heard = std::get_if<machine::Heard>(&w.step.event);
  return heard == nullptr ? nullptr : &heard->frame;
}

void mote_hears_reply(Watch& w, const Frame& frame) {
  const auto reply = rubicon::JoinReplyView::parse(frame.payload);
  if (!reply) return;
  Monitor& m = w.monitor;
  const std::uint8_t island = island_bit(w.step.options, reply->island_addr());
  const bool present = m.asked && reply->seq_num() == m.present_seq;
  if (m.open && present) m.heard |= island;
  if (m.open && m.asked && !present) w.reach(Goal::kStaleReply);
  if (!m.open && m.view != 0 && present && island != m.view) w.reach(Goal::kSecondOffer);
}

void mote_sends_request(Watch& w, Bytes payload) {
  const auto request = rubicon::JoinRequestView::parse(payload);
  Monitor& m = w.monitor;
  if (!request || !m.open) return w.breaks(Property::kRequestsBounded);
  if (m.asked && m.present_seq != request->seq_num()) m.heard = 0;
  m.asked = true;
  m.present_seq = request->seq_num();
  ++m.requests;
  if (m.requests > 1) w.reach(Goal::kRetried);
  if (m.requests > w.step.options.profile.join_requests_max) {
    w.breaks(Property::kRequestsBounded);
  }
}

void mote_sends_ack(Watch& w, Bytes payload) {
  const auto ack = rubicon::AckJoinView::parse(payload);
  if (!ack) return w.breaks(Property::kAckRightSeq);
  Monitor& m = w.monitor;
  const auto pid = static_cast<std::uint16_t>(ack->dest().pid());
  const std::uint8_t island = island_bit(w.step.options, pid);
  if (!m.asked || ack->seq_num() != m.present_seq || (m.heard & island) == 0) {
    w.breaks(Property::kAckRightSeq);
  }
  m.chosen |= island;
  if ((m.chosen & (m.chosen - 1)) != 0) w.breaks(Property::kOneIsland);
  m.acked_ever |= island;
}

void told_joined(Watch& w, const machine::Joined& joined) {
  Monitor& m = w.monitor;
  if (!m.open) w.breaks(Property::kOneTerminal);
  m.open = false;
  const std::uint8_t island = island_bit(w.step.options, joined.address.pid);
  if (!joined.success) {
    if (m.view != 0) w.reach(Goal::kJoinedAgain);
    if (m.view == 0 && m.requests == w.step.options.profile.join_requests_max) {
      w.reach(Goal::kFailed);
    }
    m.requests = 0;
    return;
  }
  const bool own = joined.address.devid == w.step.before.config.id;
  if (island == 0 || (m.heard & island) == 0 || !own) w.breaks(Property::kJoinedAfterReply);
  if (m.view != 0) w.breaks(Property::kOneIsland);
  m.view = island;
  m.heard = static_cast<std::uint8_t>(m.heard & island);  // Its other answers matter no more.
  m.requests = 0;
  if (island == 1) w.reach(Goal::kJoinedFirst);
  if (island == 2) w.reach(Goal::kJoinedSecond);
}

void sink_sends_reply(Watch& w, const machine::Transmit& transmit) {
  const auto reply = rubicon::JoinReplyView::parse(transmit.bytes());
  const Frame* const frame = heard_frame(w);
  // With a busy radio an answer may leave later than its request came.
  const bool asked = w.step.options.busy || (frame != nullptr && frame->type == am::kJoin);
  const int mote = mote_number(w.step.options, transmit.dest);
  if (!reply || mote < 0 || !asked) return w.breaks(Property::kListedSilent);
  const bool listed = machine::find_member(w.step.before.sink, transmit.dest) != nullptr;
  if (listed && w.step.options.profile.listed_ignored && !w.step.options.busy) {
    w.breaks(Property::kListedSilent);
  }
  w.monitor.answered[static_cast<std::size_t>(mote)] = {true, true, reply->seq_num()};
}

void sink_heard_ack(Watch& w, const Frame& frame) {
  const auto ack = rubicon::AckJoinView::parse(frame.payload);
  if (!ack || static_cast<std::uint16_t>(ack->dest().pid()) != w.step.before.island) return;
  const auto devid = static_cast<std::uint16_t>(ack->src().devid());
  const int mote = mote_number(w.step.options, devid);
  if (mote < 0) return;
  const Answered& answered = w.monitor.answered[static_cast<std::size_t>(mote)];
  const bool listed = machine::find_member(w.step.after.sink, devid) != nullptr;
  if (answered.ever && answered.seq_num == ack->seq_num() && !listed) {
    w.breaks(Property::kAdmitted);
  }
  if (listed && machine::find_member(w.step.before.sink, devid) != nullptr) {
    w.reach(Goal::kRepeatedAck);
  }
}

void told_mote_joined(Watch& w, const machine::MoteJoined& joined) {
  const int mote = mote_number(w.step.options, joined.address.devid);
  if (mote < 0) return w.breaks(Property::kOneReport);
  Answered& answered = w.monitor.answered[static_cast<std::size_t>(mote)];
  if (!answered.armed) w.breaks(Property::kOneReport);
  answered.armed = false;
  ++w.monitor.owed_reports;
  w.reach(Goal::kListed);
}

void sends(Watch& w, const machine::Transmit& transmit) {
  const Bytes payload = transmit.bytes();
  if (transmit.link == Link::kSerial) {
    const bool report = transmit.type == am::kNet && payload.size() >= BodyTypeAt::kEnd &&
                        BodyTypeAt::load(payload.data()) == rubicon::AmType::kSerialJoined;
    if (report) --w.monitor.owed_reports;
    return;
  }
  if (!w.is_mote()) {
    if (transmit.type == am::kJoinReply) sink_sends_reply(w, transmit);
    return;
  }
  if (transmit.type == am::kJoin) mote_sends_request(w, payload);
  if (transmit.type == am::kAckJoin) mote_sends_ack(w, payload);
  if (transmit.type == am::kNet && w.monitor.view == 0) w.breaks(Property::kMembersOnly);
}

void told_sent(Watch& w, std::uint16_t seq_num) {
  const auto* called = std::get_if<machine::Called>(&w.step.event);
  const auto* send = called == nullptr ? nullptr : std::get_if<machine::Send>(&called->call);
  if (send == nullptr || !send->reliable || seq_num == machine::kNoSeq) return;
  Monitor& m = w.monitor;
  assert(m.open_sends < m.open_send.size());
  m.open_send[m.open_sends++] = {seq_num, send->app_id};
}

void told_acked(Watch& w, const machine::AckReceived& ack) {
  Monitor& m = w.monitor;
  w.reach(ack.success ? Goal::kAckedMessage : Goal::kTimedOut);
  for (std::uint8_t i = 0; i < m.open_sends; ++i) {
    if (!(m.open_send[i] == OpenSend{ack.seq_num, ack.app_id})) continue;
    m.open_send[i] = m.open_send[--m.open_sends];
    m.open_send[m.open_sends] = {};
    return;
  }
  w.breaks(Property::kReliableEnds);
}

void told_received(Watch& w) {
  w.reach(Goal::kDelivered);
  const Frame* const frame = heard_frame(w);
  const auto message = frame == nullptr ? rubicon::NetMsgView::parse(Bytes{})
                                        : rubicon::NetMsgView::parse(frame->payload);
  if (!message) return w.breaks(Property::kOwnIslandOnly);
  const auto pid = static_cast<std::uint16_t>(message->dest().pid());
  const std::uint8_t own =
      w.is_mote() ? w.monitor.view : island_bit(w.step.options, w.step.before.island);
  const bool everybody = pid == machine::kBroadcastPid;  // Delivering it is legal: decision 114.
  if (!everybody && (own == 0 || island_bit(w.step.options, pid) != own)) {
    w.breaks(Property::kOwnIslandOnly);
  }
}

void notified(Watch& w, const machine::Notice& notice) {
  if (const auto* joined = std::get_if<machine::Joined>(&notice)) told_joined(w, *joined);
  if (const auto* joined = std::get_if<machine::MoteJoined>(&notice)) told_mote_joined(w, *joined);
  if (const auto* sent = std::get_if<machine::SendResult>(&notice)) told_sent(w, sent->seq_num);
  if (const auto* ack = std::get_if<machine::AckReceived>(&notice)) told_acked(w, *ack);
  if (std::holds_alternative<machine::Received>(notice)) told_received(w);
}

// Notes the event itself, before its consequences.
void begins(Watch& w) {
  Monitor& m = w.monitor;
  if (const auto* called = std::get_if<machine::Called>(&w.step.event)) {
    if (std::holds_alternative<machine::JoinIsland>(called->call)) {
      ++m.calls;
      m.open = true;
      if (m.view != 0) return;  // It fails at once; the call before stays the present one.
      m.asked = false;
      m.requests = 0;
      m.present_seq = 0;
      m.heard = m.chosen = 0;
    } else if (std::holds_alternative<machine::Send>(called->call)) {
      ++m.sends;
    }
  } else if (std::holds_alternative<machine::Reboot>(w.step.event)) {
    Monitor fresh;
    fresh.calls = m.calls;
    fresh.reboots = static_cast<std::uint8_t>(m.reboots + 1);
    fresh.sends = m.sends;
    fresh.acked_ever = m.acked_ever;
    m = fresh;
  } else if (const Frame* const frame = heard_frame(w);
             frame != nullptr && frame->type == am::kJoinReply && w.is_mote()) {
    mote_hears_reply(w, *frame);
  }
}

// Checks an ack that reaches its message's sender; awaited acks were read before the step.
void check_ack(Watch& w, const Frame& frame, const Monitor& before) {
  const auto message = rubicon::NetMsgView::parse(frame.payload);
  if (!message || TransIdAt::load(frame.payload.data()) != rubicon::Component::kRubiconAck) return;
  const machine::Address own = machine::own_address(w.step.before);
  const Bytes body = message->payload().from(2);
  const std::int32_t seq_num = machine::acked_seq_num(body);
  for (std::uint8_t i = 0; i < before.open_sends; ++i) {
    if (before.open_send[i].seq_num != seq_num) continue;
    if (machine::address_of(message->dest()) != own) continue;
    const auto notices = w.step.actions.notices();
    const bool told = std::any_of(notices.begin(), notices.end(), [&](const auto& notice) {
      const auto* ack = std::get_if<machine::AckReceived>(&notice);
      return ack != nullptr && ack->success && ack->seq_num == seq_num;
    });
    if (!told) w.breaks(Property::kAckCounts);
  }
}

// Checks lists and buffers after the step.
void check_bounds(Watch& w) {
  const machine::State& s = w.step.after;
  const std::size_t motes = w.step.options.motes;
  const bool lists = s.sink.members.size() <= motes && s.sink.pending.size() <= motes;
  const bool buffers = s.radio.out.size() <= s.radio.out.room() &&
                       s.radio.in.size() <= s.radio.in.room() &&
                       s.serial.out.size() <= s.serial.out.room() &&
                       s.serial.in.size() <= s.serial.in.room();
  if (!lists || !buffers) w.breaks(Property::kQueuesBounded);
  if (s.sink.pending.size() > 1) w.reach(Goal::kInterleaved);
}

void ends(Watch& w) {
  Monitor& m = w.monitor;
  const machine::State& after = w.step.after;
  const Frame* const frame = heard_frame(w);
  if (!w.is_mote()) {
    if (frame != nullptr && frame->type == am::kAckJoin) sink_heard_ack(w, *frame);
    const bool serial_idle = !after.serial.sending && after.serial.out.empty();
    if (m.owed_reports < 0 || (m.owed_reports > 0 && serial_idle)) {
      w.breaks(Property::kOneReport);
    }
  } else {
    using Phase = machine::JoinMote::Phase;
    const std::uint16_t pid = machine::own_address(after).pid;
    if (m.view != 0 && pid != 0 && island_bit(w.step.options, pid) != m.view) {
      w.breaks(Property::kOneIsland);
    }
    // This profile's calls may end without an event.
    const bool silent = !w.step.options.profile.join_fail_signalled;
    if (silent && m.open && after.join.phase == Phase::kOutside) m.open = false;
  }
  const machine::Actions& actions = w.step.actions;
  if (frame != nullptr && frame->type == am::kNet && actions.notices().empty() &&
      actions.transmits().empty()) {
    w.reach(Goal::kForeignIgnored);
  }
  check_bounds(w);
}

}  // namespace

std::uint8_t island_bit(const Options& options, std::uint16_t pid) {
  const unsigned number = static_cast<unsigned>(pid) - kFirstIsland;
  return number < options.sinks ? static_cast<std::uint8_t>(1U << number) : std::uint8_t{0};
}

int mote_number(const Options& options, std::uint16_t devid) {
  const int number = static_cast<int>(devid) - kFirstMoteId;
  return number >= 0 && number < options.motes ? number : -1;
}

void observe(Monitor& monitor, const Observed& step, Noted& noted) {
  Watch w{monitor, step, noted};
  const Frame* const frame = heard_frame(w);
  if (frame != nullptr && frame->type == am::kNet) check_ack(w, *frame, monitor);
  begins(w);
  for (const Action& action : step.actions.all()) {
    if (action.what == Action::What::kTransmit) sends(w, step.actions.transmit_of(action));
    if (action.what == Action::What::kNotify) notified(w, step.actions.notice_of(action));
  }
  ends(w);
}

}  // namespace rubric::explorer
