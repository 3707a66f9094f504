// The surroundings of a node: lines that carry its frames, and the application that it serves.
#pragma once

#include "conformance/adapters/cpp/frame.h"

namespace rubric::cpp_node {

/// Source device in the upper, destination device in the lower 16 bits.
using ChannelId = std::uint32_t;
enum class DataStatus : std::uint8_t { kNew, kOld, kUnknownChannel };

class World {
 public:
  virtual ~World() = default;
  /// Puts a frame on a line that is free. Node::confirmed must follow one that asks for a link ack.
  virtual void transmit(Line line, const Frame& frame) = 0;

  // The events of the paper's interfaces.
  virtual void joined(Address own, bool success) = 0;
  virtual void mote_joined(Address mote, const MoteDesc& description) = 0;
  virtual void received(Address src, Component application, Bytes data) = 0;
  virtual void ack_received(Component application, std::uint16_t number, bool success) = 0;
  virtual void syn_data(ChannelId channel, DataStatus status) = 0;
};

}  // namespace rubric::cpp_node
