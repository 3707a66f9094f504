#include "conformance/machine/flaws/flaws.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/app_msg.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
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

// A frame with some bytes changed, for one step. The bytes stay until the next one of the thread,
// as what a step delivers does.
class Forged {
 public:
  explicit Forged(const Frame& frame) : frame_(frame) {
    std::copy(frame.payload.begin(), frame.payload.end(), bytes_.begin());
    frame_.payload = Bytes(bytes_.data(), frame.payload.size());
  }
  std::uint8_t* bytes() { return bytes_.data(); }
  void pad() {
    std::fill(bytes_.begin() + frame_.payload.size(), bytes_.end(), std::uint8_t{0});
    frame_.payload = Bytes(bytes_.data(), bytes_.size());
  }
  Event event() const { return machine::Heard{frame_}; }

 private:
  Frame frame_;
  static thread_local std::array<std::uint8_t, machine::kAmPayloadMax> bytes_;
};
thread_local std::array<std::uint8_t, machine::kAmPayloadMax> Forged::bytes_{};

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

// Copies the consequences of a step, but for frames and notices that `keep` refuses; it may change
// what it keeps.
template <class Keep>
void rewrite(Actions& actions, Keep keep) {
  const Actions honest = actions;
  actions.clear();
  for (const Action& action : honest.all()) {
    switch (action.what) {
      case Action::What::kTransmit: {
        Transmit transmit = honest.transmit_of(action);
        if (keep(transmit)) actions.transmit(action.requirement) = transmit;
        break;
      }
      case Action::What::kNotify: {
        machine::Notice notice = honest.notice_of(action);
        if (keep(notice)) actions.notify(notice, action.requirement);
        break;
      }
      case Action::What::kFollowed: actions.followed(action.requirement); break;
      case Action::What::kIgnored: actions.ignored(action.requirement); break;
    }
  }
}

void stop_clock(const State& state, Transmit& transmit) {
  if (transmit.type != am::kJoinReply) return;
  rubicon::JoinReplyLayout::CurTimeAt::store(transmit.payload.data(), state.clock_offset_ms);
}

void time_of_boot(State& state, Ticks now, const Event& event, Actions& actions) {
  machine::step(state, now, event, actions);
  rewrite(actions, [&](auto& each) {
    if constexpr (std::is_same_v<decltype(each), Transmit&>) stop_clock(state, each);
    return true;
  });
}

void no_ack_timeout(State& state, Ticks now, const Event& event, Actions& actions) {
  state.config.profile.ack_timeout_ticks = 0;  // For good: a message then has no timer.
  if (is_timer(event, machine::TimerKind::kAck)) return actions.clear();
  machine::step(state, now, event, actions);
}

template <class At>
machine::Address address_at(const std::uint8_t* net_msg) {
  using Layout = rubicon::RAddrLayout;
  const std::uint8_t* const at = net_msg + At::kAt;
  return {static_cast<std::uint16_t>(Layout::PidAt::load(at)),
          static_cast<std::uint16_t>(Layout::DevidAt::load(at))};
}

void misread_acks(State& state, Ticks now, const Event& event, Actions& actions) {
  const Frame* const frame = heard(event, am::kNet);
  const bool ack = frame != nullptr && frame->payload.size() >= ShortAckAt::kEnd &&
                   TransIdAt::load(frame->payload.data()) == rubicon::Component::kRubiconAck;
  // What it hands on it does not read.
  const bool own =
      ack && address_at<NetMsgLayout::DestAt>(frame->payload.data()) == machine::own_address(state);
  if (!own) return machine::step(state, now, event, actions);
  const std::uint8_t* const bytes = frame->payload.data();
  const bool coded = frame->payload.size() >= AckAt::kEnd &&
                     AckTypeAt::load(bytes) == rubicon::AmType::kLearningNotification;
  const std::size_t at = coded ? AckAt::kAt : ShortAckAt::kAt;
  Forged forged(*frame);
  std::reverse(forged.bytes() + at, forged.bytes() + at + 2);
  machine::step(state, now, forged.event(), actions);
}

// The whole of release 1.0: what its captures and sources show of the firmware, and of the Java
// base station. Each difference is a function, in the order in which it acts on an event.

constexpr auto kNbytesMax = rubicon::AppMsgView::kMaxSizeBytes;

std::uint8_t& nbytes_of(std::uint8_t* net_msg) { return net_msg[NetMsgLayout::NbytesAt::kAt]; }

// Makes nbytes true of a message that has a header: release 1.0 believes it, or takes the whole
// buffer, and reads what memory holds there.
void believe_nbytes(Forged& forged, std::size_t size) {
  std::uint8_t& nbytes = nbytes_of(forged.bytes());
  if (nbytes < AppMsgLayout::PayloadAt::kAt || nbytes > kNbytesMax) nbytes = kNbytesMax;
  if (NetMsgLayout::PayloadAt::kAt + nbytes > size) forged.pad();
}

// Returns the net_msg of an event with a header, else null.
const Frame* net_msg(const Event& event) {
  const Frame* const frame = heard(event, am::kNet);
  const bool fits = frame != nullptr && frame->payload.size() >= NetMsgLayout::PayloadAt::kAt &&
                    frame->payload.size() <= machine::kAmPayloadMax;
  return fits ? frame : nullptr;
}

template <class At>
void set_address(std::uint8_t* net_msg, machine::Address address) {
  rubicon::RAddrLayout::store(machine::wire_of(address), net_msg + At::kAt);
}

// A frame that finds a full buffer takes the place of the oldest.
void overwrite_oldest(State& state, const Event& event) {
  const auto* const heard = std::get_if<machine::Heard>(&event);
  if (heard == nullptr || !state.app_busy) return;
  const auto drop = [&](auto& in, Link link) {
    if (heard->frame.link != link || !in.full()) return;
    in.pop();
    std::size_t i = 0;
    while (state.waiting[i] != link) ++i;
    state.waiting.erase(i);
  };
  drop(state.radio.in, Link::kRadio);
  drop(state.serial.in, Link::kSerial);
}

// The ack_join that a wrong reply causes is the request's own bytes, read as an ack_join.
void malform_ack(const State& state, Transmit& transmit) {
  transmit.payload.fill(0);
  rubicon::JoinRequest request;
  request.seq_num = state.join.seq_num;
  request.mote_desc = machine::wire_of(state.join.descriptor);
  rubicon::JoinRequestLayout::store(request, transmit.payload.data());
}

// Tells the application of each ack, whose number is read one byte early and in host order.
void tell_acks(const Event& event, Actions& actions) {
  constexpr auto kType = static_cast<std::uint8_t>(rubicon::AmType::kLearningNotification);
  bool unmatched = false;
  for (const Action& action : actions.all()) {
    unmatched = unmatched ||
                (action.what == Action::What::kIgnored &&
                 (action.requirement == "T3-MATCH"_rule || action.requirement == "T3-SENDER"_rule));
  }
  const auto misread = [&](machine::AckReceived& ack) {
    ack.seq_num = static_cast<std::uint16_t>((ack.seq_num & 0xFF00) | kType);
  };
  rewrite(actions, [&](auto& each) {
    if constexpr (std::is_same_v<decltype(each), machine::Notice&>) {
      if (auto* ack = std::get_if<machine::AckReceived>(&each)) misread(*ack);
    }
    return true;
  });
  const Frame* const frame = net_msg(event);
  if (!unmatched || frame == nullptr || frame->payload.size() < AckAt::kEnd) return;
  const std::uint8_t* const bytes = frame->payload.data();
  using AppIdAt = Within<NetMsgLayout::PayloadAt, AppMsgLayout::AppIdAt>;
  machine::AckReceived ack{static_cast<std::uint8_t>(AppIdAt::load(bytes)),
                           static_cast<std::uint16_t>(AckAt::load(bytes)), true};
  misread(ack);
  actions.notify(ack, "T3-SUCCESS"_rule);
}

// Signals synaptic data when they come, and not at a tick.
void tell_data_at_once(State& state, const Event& event, Actions& actions) {
  if (is_timer(event, machine::TimerKind::kSynaptic)) {
    rewrite(actions, [](auto& each) {
      if constexpr (std::is_same_v<decltype(each), machine::Notice&>) {
        const auto* const data = std::get_if<machine::SynDataReceived>(&each);
        return data == nullptr || data->status != machine::DataStatus::kOld;
      }
      return true;
    });
  }
  for (machine::Channel& in : state.synaptic.in) {
    if (!in.started || !std::exchange(in.fresh, false)) continue;
    actions.notify(machine::SynDataReceived{in.id, machine::DataStatus::kNew}, "S2-SIGNAL"_rule);
  }
}

void join_as_release_1_0(State& state, Ticks now, const Event& event, Actions& actions) {
  const bool wrong = wrong_reply(state, event) != nullptr;
  joined_on_link_ack(state, now, event, actions);
  if (wrong) state.join.address = {0, state.config.id};
  rewrite(actions, [&](auto& each) {
    if constexpr (std::is_same_v<decltype(each), Transmit&>) {
      if (wrong && each.type == am::kAckJoin) malform_ack(state, each);
      stop_clock(state, each);
      const bool forwarded =
          each.link == Link::kSerial && each.type == am::kNet &&
          address_at<NetMsgLayout::SrcAt>(each.payload.data()) != machine::own_address(state);
      if (forwarded) nbytes_of(each.payload.data()) = kNbytesMax;
    }
    return true;
  });
}

// A sink takes what is for other motes of its island, and radiates what came by serial for any
// island by its devid alone.
void route_by_devid(State& state, Ticks now, Forged& forged, Link link, Actions& actions) {
  const machine::Address dest = address_at<NetMsgLayout::DestAt>(forged.bytes());
  const bool named = !machine::is_reserved(dest.devid) && dest.devid != state.config.id;
  if (link == Link::kRadio && named && dest.pid == state.island) {
    set_address<NetMsgLayout::DestAt>(forged.bytes(), machine::own_address(state));
  }
  const bool foreign = link == Link::kSerial && named && !machine::is_reserved(dest.pid);
  const std::uint16_t island = state.island;
  if (foreign) state.island = dest.pid;
  join_as_release_1_0(state, now, forged.event(), actions);
  state.island = island;
}

void firmware(State& state, Ticks now, const Event& given, Actions& actions) {
  Event event = given;
  if (auto* const called = std::get_if<machine::Called>(&event)) {
    const auto* const send = std::get_if<machine::Send>(&called->call);
    if (send != nullptr && send->data.size() > machine::kAppDataMax) {
      throw Died("died of more than 100 bytes");
    }
    if (std::holds_alternative<machine::DisposeChannel>(called->call)) {
      actions.clear();
      return actions.notify(machine::OperationResult{true}, "S6-DISPOSED"_rule);
    }
    auto* const create = std::get_if<machine::CreateChannel>(&called->call);
    if (create != nullptr) create->mode = machine::Mode::kReliable;
  }
  overwrite_oldest(state, event);
  if (const Frame* const frame = net_msg(event)) {
    Forged forged(*frame);
    believe_nbytes(forged, frame->payload.size());
    if (state.config.role == Role::kSink) {
      route_by_devid(state, now, forged, frame->link, actions);
    } else {
      join_as_release_1_0(state, now, forged.event(), actions);
    }
  } else {
    join_as_release_1_0(state, now, event, actions);
  }
  while (state.sink.pending.size() > 1) state.sink.pending.erase(0);
  tell_acks(event, actions);
  tell_data_at_once(state, event, actions);
}

// Takes everything from its sink as its own, if it has its full length; sends nothing to PEIS.
void java_base_station(State& state, Ticks now, const Event& event, Actions& actions) {
  const Frame* const frame = net_msg(event);
  if (frame != nullptr && frame->link == Link::kSerial) {
    if (frame->payload.size() < machine::kAmPayloadMax) {
      actions.clear();
      return actions.ignored(ReqId::kNone);
    }
    Forged forged(*frame);
    believe_nbytes(forged, frame->payload.size());
    set_address<NetMsgLayout::DestAt>(forged.bytes(), machine::own_address(state));
    machine::step(state, now, forged.event(), actions);
  } else if (frame != nullptr && frame->link == Link::kPeis) {
    Forged forged(*frame);
    NetMsgLayout::ReliableAt::store(forged.bytes(), 0);
    NetMsgLayout::SeqNumAt::store(forged.bytes(), 5);
    machine::step(state, now, forged.event(), actions);
  } else {
    machine::step(state, now, event, actions);
  }
  rewrite(actions, [](auto& each) {
    if constexpr (std::is_same_v<decltype(each), Transmit&>) return each.link != Link::kPeis;
    return true;
  });
}

// Sets what release 1.0 has otherwise, and steps with it.
template <auto kStep>
void release_1_0(State& state, Ticks now, const Event& event, Actions& actions) {
  if (state.off) return machine::step(state, now, event, actions);
  machine::Profile& profile = state.config.profile;
  profile.join_requests_max = 7;
  profile.join_fail_signalled = false;
  profile.listed_ignored = false;
  profile.ack_timeout_ticks = 0;
  kStep(state, now, event, actions);
}

constexpr std::array<ReqId, 3> rules(ReqId a, ReqId b = ReqId::kNone, ReqId c = ReqId::kNone) {
  return {a, b, c};
}

constexpr Role kFirmwareRoles[] = {Role::kMote, Role::kSink};
constexpr Role kBaseStationRoles[] = {Role::kBaseStation};
constexpr std::array<Flaw, 2> kWhole{{
    {"release_1_0_firmware", "A mote or sink does all that is known of the firmware.",
     rules("J4-SEQ"_rule, "J9-INTERLEAVE"_rule, "T3-SUCCESS"_rule), Seen::kTime,
     release_1_0<firmware>, kFirmwareRoles},
    {"release_1_0_base_station", "A base station does all that is known of the Java base station.",
     rules("N8-PEIS"_rule, "N8-INCOMING"_rule, "T3-TIMEOUT"_rule), Seen::kTime,
     release_1_0<java_base_station>, kBaseStationRoles},
}};
constexpr std::array<Flaw, 10> kFlaws{{
    {"accepts_wrong_seq", "A mote that is joining accepts a reply with any sequence number.",
     rules("J4-SEQ"_rule, "J5-ACCEPT"_rule), Seen::kJoin, accepts_wrong_seq},
    {"one_pending_seq", "A sink remembers one request, the newest of all motes.",
     rules("J9-INTERLEAVE"_rule, "J6-ADD"_rule), Seen::kJoin, one_pending_seq},
    {"joined_on_link_ack",
     "A mote acks a reply with a wrong number, and is joined when the radio confirms that.",
     rules("J5-ACCEPT"_rule, "J4-SEQ"_rule, "J4-CONTENT"_rule), Seen::kJoin, joined_on_link_ack},
    {"no_fail", "A mote that has sent its last request says nothing when the timer expires.",
     rules("J8-FAIL"_rule, "J5-ONCE"_rule), Seen::kJoin, no_fail},
    {"seven_requests", "A mote sends two join_requests more than it may.",
     rules("J8-LIMIT"_rule, "J8-FAIL"_rule), Seen::kJoin, seven_requests},
    {"acks_wrong_seq", "A mote sends ack_join for a reply with a wrong number, and goes on.",
     rules("J4-SEQ"_rule, "J4-CONTENT"_rule), Seen::kJoin, acks_wrong_seq},
    {"answers_members", "A sink answers requests of motes that it lists.", rules("J2-LISTED"_rule),
     Seen::kJoin, answers_members},
    {"no_ack_timeout", "A reliable message whose ack does not come stays open for ever.",
     rules("T3-TIMEOUT"_rule, "T3-ONCE"_rule), Seen::kMessages, no_ack_timeout},
    {"misread_acks", "The receiver of an ack reads its sequence number in the wrong byte order.",
     rules("T3-SUCCESS"_rule), Seen::kMessages, misread_acks},
    {"time_of_boot", "A sink's cur_time is the time at which it booted.", rules("J3-TIME"_rule),
     Seen::kTime, time_of_boot},
}};

}  // namespace

std::span<const Flaw> all() { return kFlaws; }
std::span<const Flaw> whole_releases() { return kWhole; }

const Flaw* find(std::string_view name) {
  for (const std::span<const Flaw> flaws : {all(), whole_releases()}) {
    for (const Flaw& flaw : flaws) {
      if (name == flaw.name) return &flaw;
    }
  }
  return nullptr;
}

}  // namespace rubric::flaws
