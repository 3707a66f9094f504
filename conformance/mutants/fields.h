// Offsets of the fields that mutants change.
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/machine/messages.h"
#include "conformance/mutants/wrapped.h"

namespace rubric::mutants {

namespace am = machine::am;
namespace component = machine::component;

/// Offsets in bytes.
namespace net {
constexpr std::size_t kDestPid = 0;
constexpr std::size_t kDestDevid = 2;
constexpr std::size_t kSrcPid = 4;
constexpr std::size_t kSrcDevid = 6;
constexpr std::size_t kReliable = 8;
constexpr std::size_t kSeqNum = 9;
constexpr std::size_t kNbytes = 11;
constexpr std::size_t kTransId = 12;
constexpr std::size_t kAppId = 13;
constexpr std::size_t kBody = 14;
constexpr std::size_t kAckedSeq = 15;  ///< After the type of the body.
}  // namespace net
namespace join_request {
constexpr std::size_t kSeqNum = 0;
constexpr std::size_t kMoteType = 2;
constexpr std::size_t kTransducers = 3;
constexpr std::size_t kActuators = 5;
}  // namespace join_request
namespace join_reply {
constexpr std::size_t kIsland = 0;
constexpr std::size_t kMote = 2;
constexpr std::size_t kTime = 4;
constexpr std::size_t kSeqNum = 8;
}  // namespace join_reply
namespace ack_join {
constexpr std::size_t kDestPid = 0;
constexpr std::size_t kDestDevid = 2;
constexpr std::size_t kSrcPid = 4;
constexpr std::size_t kSrcDevid = 6;
constexpr std::size_t kSeqNum = 8;
constexpr std::size_t kTransducers = 11;
}  // namespace ack_join

inline std::uint16_t get(const Transmit& frame, std::size_t offset) {
  return load_be16(frame.payload.data() + offset);
}
inline void put(Transmit& frame, std::size_t offset, unsigned value) {
  store_be16(frame.payload.data() + offset, static_cast<std::uint16_t>(value));
}
inline std::uint16_t get(const Frame& frame, std::size_t offset) {
  return load_be16(frame.payload.data() + offset);
}
inline std::uint16_t get(const Forged& forged, std::size_t offset) {
  return load_be16(forged.bytes.data() + offset);
}
inline void put(Forged& forged, std::size_t offset, unsigned value) {
  store_be16(forged.bytes.data() + offset, static_cast<std::uint16_t>(value));
}

/// A net_msg with TRANSID and APPID.
inline bool is_net(const Transmit& frame) {
  return frame.type == am::kNet;
}
inline bool is_net(const Frame& frame) {
  return frame.type == am::kNet && frame.payload.size() >= net::kBody;
}
inline bool is_ack(const Transmit& frame) {
  return is_net(frame) && frame.payload[net::kTransId] == component::kRubiconAck;
}
inline bool is_ack(const Frame& frame) {
  return is_net(frame) && frame.payload[net::kTransId] == component::kRubiconAck &&
         frame.payload.size() > net::kAckedSeq + 1;
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
inline machine::Address own(const Moment& moment) {
  return machine::own_address(moment.state);
}
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
inline StepMaker drop_sent(bool (*which)(const Moment&, const Transmit&)) {
  return on_sent([which](Moment& moment, const Action&, Transmit& frame) {
    return which(moment, frame) ? Fate::kDrop : Fate::kKeep;
  });
}
inline StepMaker double_sent(bool (*which)(const Moment&, const Transmit&)) {
  return on_sent([which](Moment& moment, const Action&, Transmit& frame) {
    return which(moment, frame) ? Fate::kTwice : Fate::kKeep;
  });
}
/// Makes a wrapper that changes a 16-bit field in frames of a type.
inline StepMaker sent_field(std::uint8_t am_type, std::size_t offset,
                            unsigned (*other)(const Moment&, unsigned)) {
  return on_sent([=](Moment& moment, const Action&, Transmit& frame) {
    if (frame.type == am_type) put(frame, offset, other(moment, get(frame, offset)));
    return Fate::kKeep;
  });
}
/// Makes a wrapper that ignores no such frame: it mends the frame first.
inline StepMaker mended(bool (*wrong)(const Moment&, const Frame&),
                        void (*mend)(Moment&, Forged&)) {
  return on_heard([=](Moment& moment, Forged& forged) {
    if (wrong(moment, forged.frame)) mend(moment, forged);
    return true;
  });
}

}  // namespace rubric::mutants
