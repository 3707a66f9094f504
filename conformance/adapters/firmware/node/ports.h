// A node's interfaces to its hardware and its application. A port to a board implements these four
// and calls the node on events (node.h).
#pragma once

#include "codec/runtime/bytes.h"
#include "conformance/adapters/firmware/node/types.h"

namespace rubric {
namespace firmware {

/// A radio chip, which takes one frame at a time and handles access to the channel itself.
class Radio {
 public:
  /// Takes a copy of `payload` and sends it as soon as the channel is free. With `link_ack` the
  /// receiver's radio is asked to confirm it. Node::radio_sent ends it; until then the node sends
  /// no other.
  virtual void send(uint16_t dest, uint8_t am_type, Bytes payload, bool link_ack) = 0;
  /// Saves power while off; a frame being sent may end.
  virtual void set_on(bool on) = 0;

 protected:
  ~Radio() = default;
};

/// A serial line that carries whole packets (dispatch byte, AM header, payload).
class SerialLine {
 public:
  /// Borrows `packet` until Node::serial_sent is called.
  virtual void send(Bytes packet) = 0;
  /// While off nothing is received or confirmed; a packet being sent may end.
  virtual void set_on(bool on) = 0;

 protected:
  ~SerialLine() = default;
};

class Clock {
 public:
  /// Returns the time, 1024 to the second, since the node started.
  virtual Ticks now() const = 0;

 protected:
  ~Clock() = default;
};

/// News for the application. It may call the node from here.
class Application {
 public:
  virtual void joined(Address address, bool success) = 0;
  virtual void mote_joined(Address address, const Descriptor& descriptor) = 0;
  /// `data` is valid until this returns.
  virtual void received(Address src, uint8_t app_id, Bytes data) = 0;
  virtual void ack_received(uint8_t app_id, uint16_t seq_num, bool success) = 0;
  virtual void syn_data_received(ChannelId channel, DataStatus status) = 0;

 protected:
  ~Application() = default;
};

}  // namespace firmware
}  // namespace rubric
