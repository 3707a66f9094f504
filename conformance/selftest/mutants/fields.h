// Offsets of the fields that mutants change.
#pragma once

#include <algorithm>
#include <type_traits>

#include "codec/generated/rubicon/ack_join.h"
#include "codec/generated/rubicon/config.h"
#include "codec/generated/rubicon/join_reply.h"
#include "codec/generated/rubicon/join_request.h"
#include "codec/generated/rubicon/net_msg.h"
#include "codec/generated/rubicon/serial_joined.h"
#include "conformance/machine/messages.h"
#include "conformance/selftest/mutants/wrapped.h"

namespace rubric::mutants {

namespace am = machine::am;
namespace component = machine::component;

/// Fields by their places in the payload; each converts to its offset in bytes.
namespace net {
using Net = rubicon::NetMsgLayout;
using App = rubicon::AppMsgLayout;
using Address = rubicon::RAddrLayout;
using BodyAt = PlaceAt<Net::PayloadAt::kAt + App::PayloadAt::kAt>;
constexpr Within<Net::DestAt, Address::PidAt> kDestPid;
constexpr Within<Net::DestAt, Address::DevidAt> kDestDevid;
constexpr Within<Net::SrcAt, Address::PidAt> kSrcPid;
constexpr Within<Net::SrcAt, Address::DevidAt> kSrcDevid;
constexpr Net::ReliableAt kReliable;
constexpr Net::SeqNumAt kSeqNum;
constexpr Net::NbytesAt kNbytes;
constexpr Within<Net::PayloadAt, App::TransIdAt> kTransId;
constexpr Within<Net::PayloadAt, App::AppIdAt> kAppId;
constexpr BodyAt kBody;
constexpr Within<BodyAt, rubicon::RubiconAckLayout::SeqNumAt> kAckedSeq;
/// The fields of an ack in the paper's form.
constexpr Within<BodyAt, rubicon::RubiconAckSeqOnlyLayout::SeqNumAt> kPaperSeq;
constexpr Within<BodyAt, rubicon::SerialJoinedLayout::MoteAddrAt> kReportedMote;
constexpr Within<BodyAt, rubicon::SerialJoinedLayout::TransducersAt> kReportedTransducers;

// Bodies that nodes make themselves: the first byte, and nbytes of the whole.
constexpr auto kReport = static_cast<std::uint8_t>(rubicon::AmType::kSerialJoined);
constexpr auto kAck = static_cast<std::uint8_t>(rubicon::AmType::kLearningNotification);
constexpr std::size_t kReportNbytes =
    App::PayloadAt::kAt + rubicon::SerialJoinedView::kMaxSizeBytes;
constexpr std::size_t kAckNbytes = App::PayloadAt::kAt + rubicon::RubiconAckView::kMaxSizeBytes;
constexpr std::size_t kPaperAckNbytes =
    App::PayloadAt::kAt + rubicon::RubiconAckSeqOnlyView::kMaxSizeBytes;
}  // namespace net
namespace join_request {
using Request = rubicon::JoinRequestLayout;
constexpr Request::SeqNumAt kSeqNum;
constexpr Within<Request::MoteDescAt, rubicon::MoteDescLayout::MoteTypeAt> kMoteType;
constexpr Within<Request::MoteDescAt, rubicon::MoteDescLayout::TransducersAt> kTransducers;
constexpr Within<Request::MoteDescAt, rubicon::MoteDescLayout::ActuatorsAt> kActuators;
}  // namespace join_request
namespace join_reply {
constexpr rubicon::JoinReplyLayout::IslandAddrAt kIsland;
constexpr rubicon::JoinReplyLayout::MoteAddrAt kMote;
constexpr rubicon::JoinReplyLayout::CurTimeAt kTime;
constexpr rubicon::JoinReplyLayout::SeqNumAt kSeqNum;
}  // namespace join_reply
namespace config {
constexpr rubicon::ConfigLayout::TypeAt kType;
constexpr rubicon::ConfigLayout::ValueAt kValue;
constexpr auto kSetIslandId = static_cast<std::uint8_t>(rubicon::CommandCode::kSetIslandId);
}  // namespace config
namespace ack_join {
using Ack = rubicon::AckJoinLayout;
using net::Address;
constexpr Within<Ack::DestAt, Address::PidAt> kDestPid;
constexpr Within<Ack::DestAt, Address::DevidAt> kDestDevid;
constexpr Within<Ack::SrcAt, Address::PidAt> kSrcPid;
constexpr Within<Ack::SrcAt, Address::DevidAt> kSrcDevid;
constexpr Ack::SeqNumAt kSeqNum;
constexpr Within<Ack::MoteDescAt, rubicon::MoteDescLayout::TransducersAt> kTransducers;
}  // namespace ack_join

/// A field's number, whatever it means.
template <class Field>
using Raw = std::conditional_t<
    Field::Number::kSizeBytes == 1, std::uint8_t,
    std::conditional_t<Field::Number::kSizeBytes == 2, std::uint16_t, std::uint32_t>>;

template <class Field>
Raw<Field> get(const std::uint8_t* payload, Field) {
  const auto value = Field::load(payload);
  if constexpr (requires { value.raw(); }) {
    return value.raw();
  } else {
    return static_cast<Raw<Field>>(value);
  }
}
template <class Field>
void put(std::uint8_t* payload, Field, unsigned value) {
  Field::store(payload, static_cast<typename Field::Value>(static_cast<Raw<Field>>(value)));
}
template <class Field>
Raw<Field> get(const Transmit& frame, Field field) {
  return get(frame.payload.data(), field);
}
template <class Field>
Raw<Field> get(const Frame& frame, Field field) {
  return get(frame.payload.data(), field);
}
template <class Field>
Raw<Field> get(const Forged& forged, Field field) {
  return get(forged.bytes.data(), field);
}
template <class Field>
void put(Transmit& frame, Field field, unsigned value) {
  put(frame.payload.data(), field, value);
}
template <class Field>
void put(Forged& forged, Field field, unsigned value) {
  put(forged.bytes.data(), field, value);
}

/// Copies an address, given by the places of its pid.
inline void copy_address(const Frame& from, std::size_t at, Transmit& to, std::size_t to_at) {
  std::copy_n(from.payload.begin() + at, rubicon::RAddrView::kMaxSizeBytes,
              to.payload.begin() + to_at);
}

/// A net_msg with TRANSID and APPID.
inline bool is_net(const Transmit& frame) { return frame.type == am::kNet; }
inline bool is_net(const Frame& frame) {
  return frame.type == am::kNet && frame.payload.size() >= net::kBody;
}
inline bool is_ack(const Transmit& frame) {
  return is_net(frame) && frame.payload[net::kTransId] == component::kRubiconAck;
}
inline bool is_ack(const Frame& frame) {
  return is_net(frame) && frame.payload[net::kTransId] == component::kRubiconAck &&
         frame.payload.size() >= net::kAckedSeq.kEnd;
}
inline bool is_synaptic(const Transmit& frame) {
  return is_net(frame) && frame.payload[net::kTransId] == component::kSynChannel;
}
/// Returns whether this step's call of send made the net_msg.
inline bool is_send(const Moment& moment, const Transmit& frame) {
  return is_net(frame) && moment.called<machine::Send>() != nullptr;
}
/// Returns whether the net_msg was heard in this step and is passed on.
inline bool is_forward(const Moment& moment, const Transmit& frame) {
  const Frame* const heard = moment.heard(am::kNet);
  return heard != nullptr && is_net(frame) && heard->link != frame.link && !is_ack(frame);
}

/// Returns the address under which a node is reached now.
inline machine::Address own(const Moment& moment) { return machine::own_address(moment.state); }
inline bool is_member(const Moment& moment) {
  return moment.state.join.phase == machine::JoinMote::Phase::kMember;
}
inline bool is_joining(const Moment& moment) {
  return moment.state.join.phase == machine::JoinMote::Phase::kJoining;
}

/// Makes a wrapper with a memory of its own, which begins as Memory{}.
template <class Memory>
StepMaker remembering(void (*step)(Moment&, Memory&)) {
  return [step]() -> Step {
    return [step, memory = Memory{}](Moment& moment) mutable { step(moment, memory); };
  };
}
/// Makes a wrapper that changes a field in some frames that are sent, or sets it.
template <class Field, std::invocable<const Moment&, unsigned> Other>
StepMaker sent_field(Which<Transmit> which, Field field, Other other) {
  return on_sent([=](Moment& moment, const Action&, Transmit& frame) {
    if (which(moment, frame)) put(frame, field, other(moment, get(frame, field)));
    return Fate::kKeep;
  });
}
template <class Field>
StepMaker sent_field(Which<Transmit> which, Field field, unsigned value) {
  return sent_field(which, field, [=](const Moment&, unsigned) { return value; });
}

}  // namespace rubric::mutants
