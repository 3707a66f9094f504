// A node's two neighbours: the driver of its lines and its application.
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/node/types.h"

namespace rubric {
namespace node {

/// Puts packets on the lines. A packet is what rct/1 carries: dispatch byte, AM header, payload;
/// over PEIS dest and src of the AM header are islands.
class Driver {
 public:
  /// Puts a packet on a line that is free; the node sends no other on it before Node::sent(line).
  /// For the radio, whose chip takes a copy and minds the channel itself, `packet` is valid until
  /// this returns, on the other lines until sent(line). With `link_ack` the receiver's radio is
  /// asked to confirm it. From here the driver may call `sent` and `set_busy` of that line, if it
  /// has taken a copy, and nothing else of the node.
  virtual void transmit(Line line, Bytes packet, bool link_ack) = 0;

 protected:
  ~Driver() = default;
};

/// Takes the events of the paper's interfaces. It may call the node from here.
class Application {
 public:
  virtual void joined(Address own, bool success) = 0;
  /// A sink has a new member.
  virtual void mote_joined(Address mote, const Descriptor& descriptor) = 0;
  /// Nothing came from a mote for a stated time; only with Silence.
  virtual void mote_left(Address) {}
  /// `data` is valid until this returns.
  virtual void received(Address src, uint8_t app_id, Bytes data) = 0;
  virtual void ack_received(uint8_t app_id, uint16_t seq_num, bool success) = 0;
  virtual void syn_data_received(ChannelId channel, DataStatus status) = 0;

 protected:
  ~Application() = default;
};

}  // namespace node
}  // namespace rubric
