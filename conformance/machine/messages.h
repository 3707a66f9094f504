// Converts between the codec's messages and the machine's plain numbers.
#pragma once

#include "codec/generated/rubicon/enums.h"
#include "codec/generated/rubicon/mote_desc.h"
#include "codec/generated/rubicon/r_addr.h"
#include "conformance/machine/address.h"

namespace rubric::machine {

/// AM types that the machine knows.
namespace am {
constexpr auto kJoin = static_cast<std::uint8_t>(rubicon::AmType::kJoin);
constexpr auto kJoinReply = static_cast<std::uint8_t>(rubicon::AmType::kJoinReply);
constexpr auto kAckJoin = static_cast<std::uint8_t>(rubicon::AmType::kAckJoin);
constexpr auto kNet = static_cast<std::uint8_t>(rubicon::AmType::kNet);
constexpr auto kConfig = static_cast<std::uint8_t>(rubicon::AmType::kConfig);
}  // namespace am

/// TRANSID and APPID values that the machine sends or checks.
namespace component {
constexpr auto kSynChannel = static_cast<std::uint8_t>(rubicon::Component::kSynChannel);
constexpr auto kConnless = static_cast<std::uint8_t>(rubicon::Component::kConnless);
constexpr auto kRubiconAck = static_cast<std::uint8_t>(rubicon::Component::kRubiconAck);
constexpr auto kControlLayer = static_cast<std::uint8_t>(rubicon::Component::kControlLayer);
constexpr auto kEsnData = static_cast<std::uint8_t>(rubicon::Component::kEsnData);
}  // namespace component

inline rubicon::RAddr wire_of(Address address) {
  rubicon::RAddr wire;
  wire.pid = static_cast<rubicon::Pid>(address.pid);
  wire.devid = static_cast<rubicon::Devid>(address.devid);
  return wire;
}
inline Address address_of(rubicon::RAddrView view) {
  return {static_cast<std::uint16_t>(view.pid()), static_cast<std::uint16_t>(view.devid())};
}

inline rubicon::MoteDesc wire_of(const Descriptor& descriptor) {
  rubicon::MoteDesc wire;
  wire.mote_type = static_cast<rubicon::MoteType>(descriptor.mote_type);
  wire.transducers = rubicon::TransducerMask(descriptor.transducers);
  wire.actuators = rubicon::ActuatorMask(descriptor.actuators);
  return wire;
}
inline Descriptor descriptor_of(rubicon::MoteDescView view) {
  return {static_cast<std::uint8_t>(view.mote_type()), view.actuators().raw(),
          view.transducers().raw()};
}

}  // namespace rubric::machine
