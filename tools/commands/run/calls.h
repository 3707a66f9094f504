// Calls of an application, made at the node.
#pragma once

#include <optional>

#include "conformance/machine/event.h"
#include "conformance/node/node.h"

namespace rubric::run {

/// Makes a call. Returns its result; nothing for joinIsland, which ends in Joined.
std::optional<machine::Notice> perform(const machine::Call& call, node::Node& node);

inline machine::Address address_of(node::Address address) { return {address.pid, address.devid}; }

inline machine::Descriptor descriptor_of(const node::Descriptor& descriptor) {
  machine::Descriptor out;
  out.mote_type = static_cast<std::uint8_t>(descriptor.mote_type);
  out.actuators = descriptor.actuators.raw();
  out.transducers = descriptor.transducers.raw();
  return out;
}

}  // namespace rubric::run
