#include "conformance/machine/flaws/flaws.h"

#include <algorithm>
#include <utility>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/rubicon_ack.h"
#include "codec/generated/rubicon/rubicon_ack_seq_only.h"
#include "conformance/machine/messages.h"

namespace rubric::flaws {
namespace {

using machine::Action;
using machine::Actions;
using machine::Event;
using machine::Frame;
using machine::JoinMote;
using machine::Link;
using machine::Role;
using machine::State;
using machine::Ticks;
using machine::Transmit;
using Phase = machine::JoinMote::Phase;
namespace am = machine::am;

using rubicon::AppMsgLayout;
using rubicon::NetMsgLayout;
template <class Field>
using OfBody = Within<NetMsgLayout::PayloadAt, Within<AppMsgLayout::PayloadAt, Field>>;
using AckTypeAt = OfBody<rubicon::RubiconAckLayout::TypeAt>;
using AckAt = OfBody<rubicon::RubiconAckLayout::SeqNumAt>;
using ShortAckAt = OfBody<rubicon::RubiconAckSeqOnlyLayout::SeqNumAt>;
using TransIdAt = Within<NetMsgLayout::PayloadAt, AppMsgLayout::TransIdAt>;

const Frame* heard(const Event& event, std::uint8_t type) {
  const auto* h = std::get_if<machine::Heard>(&event);
  return h != nullptr && h->frame.type == type ? &h->frame : nullptr;
}

bool is_timer(const Event& event, machine::TimerKind kind) {
  const auto* timer = std::get_if<machine::TimerDue>(&event);
  return timer != nullptr && timer->timer.kind == kind;
}

// A frame with some bytes changed, for one step.
class Forged {
 public:
  explicit Forged(const Frame& frame) : frame_(frame) {
    std::copy(frame.payload.begin(), frame.payload.end(), bytes_.begin());
    frame_.payload = Bytes(bytes_.data(), frame.payload.size());
  }
  std::uint8_t* bytes() { return bytes_.data(); }
  Event event() const { return machine::Heard{frame_}; }

 private:
  Frame frame_;
  std::array<std::uint8_t, machine::kAmPayloadMax> bytes_{};
};

// Returns a join_reply for this mote, while it is joining, with another number than its request's.
const Frame* wrong_reply(const State& state, const Event& event) {
  const Frame* const frame = heard(event, am::kJoinReply);
  const bool joining = state.config.role == Role::kMote && state.join.phase == Phase::kJoining;
  if (frame == nullptr || !joining || frame->dest != state.config.id) return nullptr;
  const auto reply = rubicon::JoinReplyView::parse(frame->payload);
  return reply && reply->seq_num() != state.join.seq_num ? frame : nullptr;
}

void accepts_wrong_seq(State& state, Ticks now, const Event& event, Actions& actions) {
  const Frame* const frame = wrong_reply(state, event);
  if (frame == nullptr) return machine::step(state, now, event, actions);
  Forged forged(*frame);
  rubicon::JoinReplyLayout::SeqNumAt::store(forged.bytes(), state.join.seq_num);
  machine::step(state, now, forged.event(), actions);
}

void one_pending_seq(State& state, Ticks now, const Event& event, Actions& actions) {
  machine::step(state, now, event, actions);
  while (state.sink.pending.size() > 1) state.sink.pending.erase(0);  // The newest is the last.
}

// Sends ack_join for a reply that was not accepted. Keeps its address where a member's is.
void ack_wrong_reply(State& state, const Frame& frame, Actions& actions) {
  auto& radio = state.radio;
  if (!radio.on || radio.sending || radio.taken) return;
  const auto reply = rubicon::JoinReplyView::parse(frame.payload);
  state.join.address = {reply->island_addr(), reply->mote_addr()};
  state.join.sink_devid = frame.src;
  radio.sending = radio.sending_ack_join = true;
  rubicon::AckJoin ack;
  ack.dest = machine::wire_of(machine::Address{state.join.address.pid, frame.src});
  ack.src = machine::wire_of(state.join.address);
  ack.seq_num = reply->seq_num();
  ack.mote_desc = machine::wire_of(state.join.descriptor);
  Transmit& transmit = actions.transmit("J4-ACK"_rule);
  transmit.link = Link::kRadio;
  transmit.link_ack = true;
  transmit.type = am::kAckJoin;
  transmit.dest = frame.src;
  transmit.src = state.config.id;
  transmit.size_bytes = rubicon::AckJoinView::kMaxSizeBytes;
  rubicon::AckJoinLayout::store(ack, transmit.payload.data());
}

void acks_wrong_seq(State& state, Ticks now, const Event& event, Actions& actions) {
  const Frame* const frame = wrong_reply(state, event);
  machine::step(state, now, event, actions);
  if (frame != nullptr) ack_wrong_reply(state, *frame, actions);
}

void joined_on_link_ack(State& state, Ticks now, const Event& event, Actions& actions) {
  const auto* done = std::get_if<machine::SendDone>(&event);
  const bool confirmed = done != nullptr && done->link == Link::kRadio && done->acked &&
                         state.radio.sending && state.radio.sending_ack_join &&
                         state.join.phase == Phase::kJoining;
  acks_wrong_seq(state, now, event, actions);
  if (!confirmed) return;
  state.join.phase = Phase::kMember;
  state.join.acked = true;
  state.join.due = 0;
  actions.notify(machine::Joined{state.join.address, true}, "J5-SUCCESS"_rule);
}

void no_fail(State& state, Ticks now, const Event& event, Actions& actions) {
  const bool signalled = std::exchange(state.config.profile.join_fail_signalled, false);
  machine::step(state, now, event, actions);
  state.config.profile.join_fail_signalled = signalled;
}

void seven_requests(State& state, Ticks now, const Event& event, Actions& actions) {
  const std::uint8_t most = state.config.profile.join_requests_max;
  state.config.profile.join_requests_max = static_cast<std::uint8_t>(most + 2);
  machine::step(state, now, event, actions);
  state.config.profile.join_requests_max = most;
}

void answers_members(State& state, Ticks now, const Event& event, Actions& actions) {
  const bool ignored = std::exchange(state.config.profile.listed_ignored, false);
  machine::step(state, now, event, actions);
  state.config.profile.listed_ignored = ignored;
}

void time_of_boot(State& state, Ticks now, const Event& event, Actions& actions) {
  Actions honest;
  machine::step(state, now, event, honest);
  actions.clear();
  for (const Action& action : honest.all()) {
    switch (action.what) {
      case Action::What::kTransmit: {
        Transmit& transmit = actions.transmit(action.requirement);
        transmit = honest.transmit_of(action);
        if (transmit.type == am::kJoinReply) {
          rubicon::JoinReplyLayout::CurTimeAt::store(transmit.payload.data(),
                                                     state.clock_offset_ms);
        }
        break;
      }
      case Action::What::kNotify:
        actions.notify(honest.notice_of(action), action.requirement);
        break;
      case Action::What::kFollowed: actions.followed(action.requirement); break;
      case Action::What::kIgnored: actions.ignored(action.requirement); break;
    }
  }
}

void no_ack_timeout(State& state, Ticks now, const Event& event, Actions& actions) {
  state.config.profile.ack_timeout_ticks = 0;  // For good: a message then has no timer.
  if (is_timer(event, machine::TimerKind::kAck)) return actions.clear();
  machine::step(state, now, event, actions);
}

void misread_acks(State& state, Ticks now, const Event& event, Actions& actions) {
  const Frame* const frame = heard(event, am::kNet);
  const bool ack = frame != nullptr && frame->payload.size() >= ShortAckAt::kEnd &&
                   TransIdAt::load(frame->payload.data()) == rubicon::Component::kRubiconAck;
  if (!ack) return machine::step(state, now, event, actions);
  const std::uint8_t* const bytes = frame->payload.data();
  const bool coded = frame->payload.size() >= AckAt::kEnd &&
                     AckTypeAt::load(bytes) == rubicon::AmType::kLearningNotification;
  const std::size_t at = coded ? AckAt::kAt : ShortAckAt::kAt;
  Forged forged(*frame);
  std::reverse(forged.bytes() + at, forged.bytes() + at + 2);
  machine::step(state, now, forged.event(), actions);
}

constexpr ReqId kNone = ReqId::kNone;
constexpr std::array<Flaw, 10> kFlaws{{
    {"accepts_wrong_seq",
     "A mote that is joining accepts a reply with any sequence number.",
     {"J4-SEQ"_rule, "J5-ACCEPT"_rule, kNone},
     Seen::kJoin,
     accepts_wrong_seq},
    {"one_pending_seq",
     "A sink remembers one request, the newest of all motes.",
     {"J9-INTERLEAVE"_rule, "J6-ADD"_rule, kNone},
     Seen::kJoin,
     one_pending_seq},
    {"joined_on_link_ack",
     "A mote acks a reply with a wrong number, and is joined when the radio confirms that.",
     {"J5-ACCEPT"_rule, "J4-SEQ"_rule, "J4-CONTENT"_rule},
     Seen::kJoin,
     joined_on_link_ack},
    {"no_fail",
     "A mote that has sent its last request says nothing when the timer expires.",
     {"J8-FAIL"_rule, "J5-ONCE"_rule, kNone},
     Seen::kJoin,
     no_fail},
    {"seven_requests",
     "A mote sends two join_requests more than it may.",
     {"J8-LIMIT"_rule, "J8-FAIL"_rule, kNone},
     Seen::kJoin,
     seven_requests},
    {"acks_wrong_seq",
     "A mote sends ack_join for a reply with a wrong number, and goes on.",
     {"J4-SEQ"_rule, "J4-CONTENT"_rule, kNone},
     Seen::kJoin,
     acks_wrong_seq},
    {"answers_members",
     "A sink answers requests of motes that it lists.",
     {"J2-LISTED"_rule, kNone, kNone},
     Seen::kJoin,
     answers_members},
    {"no_ack_timeout",
     "A reliable message whose ack does not come stays open for ever.",
     {"T3-TIMEOUT"_rule, "T3-ONCE"_rule, kNone},
     Seen::kMessages,
     no_ack_timeout},
    {"misread_acks",
     "The receiver of an ack reads its sequence number in the wrong byte order.",
     {"T3-SUCCESS"_rule, kNone, kNone},
     Seen::kMessages,
     misread_acks},
    {"time_of_boot",
     "A sink's cur_time is the time at which it booted.",
     {"J3-TIME"_rule, kNone, kNone},
     Seen::kTime,
     time_of_boot},
}};

}  // namespace

std::span<const Flaw> all() { return kFlaws; }

const Flaw* find(std::string_view name) {
  for (const Flaw& flaw : kFlaws) {
    if (name == flaw.name) return &flaw;
  }
  return nullptr;
}

}  // namespace rubric::flaws
