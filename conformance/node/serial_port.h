// The TinyOS serial stack of a mote over any UART: HDLC-like frames, CRC, confirmations.
// (TEP 113)
#pragma once

#include "codec/runtime/hdlc.h"
#include "conformance/node/node.h"

namespace rubric {
namespace node {

/// Kind, sequence number, packet, CRC.
constexpr size_t kSerialContentMax = 2 + kAmHeaderBytes + kAmPayloadMax + kSerialCrcBytes;

/// Handles a byte at a time, in the UART's interrupts or in place of them.
class SerialPort {
 public:
  SerialPort() : receivers_{HdlcDeframer(contents_[0]), HdlcDeframer(contents_[1])} {}

  // From the UART's interrupts.

  void byte_received(uint8_t byte);
  /// Sets the next byte to send; returns false if there is none. start_sending() is called when
  /// there is one again.
  bool next_byte(uint8_t& byte);

  // From the main loop.

  /// Borrows `packet` until poll has passed its end to the node.
  void send(Bytes packet);
  /// Notes that the other side takes no bytes now, or takes them again: clear to send.
  void set_held(bool held);
  /// Returns whether poll has something to do.
  bool has_news() const { return ready_ != kNone || sent_; }
  /// Passes arrived packets and ends of transmissions to the node; returns the number of packets.
  /// While the node has switched its serial line off nothing is received or confirmed.
  uint8_t poll(Node& node);
  bool is_sending() const { return packet_size_ != 0 || ack_pending_; }

 protected:
  /// Makes the UART ask for bytes, if it does not.
  virtual void start_sending() = 0;
  ~SerialPort() = default;

 private:
  enum : uint8_t { kNone = 0xFF };
  enum class Step : uint8_t { kIdle, kKind, kBody, kCrcLow, kCrcHigh, kClose };

  bool begin_frame();
  void end_frame();
  uint8_t body_byte();
  uint8_t escaped(uint8_t byte);
  uint8_t counted(uint8_t byte);

  uint8_t contents_[2][kSerialContentMax];
  HdlcDeframer receivers_[2];  ///< One is filled while the other's frame waits for poll.
  uint8_t filling_ = 0;
  volatile uint8_t ready_ = kNone;  ///< The receiver whose frame waits.
  volatile bool on_ = true;
  volatile bool held_ = false;
  volatile bool sent_ = false;
  volatile bool ack_pending_ = false;
  volatile uint8_t packet_size_ = 0;  ///< 0: no packet is to be sent.
  const uint8_t* volatile packet_ = nullptr;
  Step step_ = Step::kIdle;
  bool sending_ack_ = false;
  uint8_t ack_seq_ = 0;
  uint8_t position_ = 0;
  uint8_t behind_escape_ = 0;  ///< The byte to send next; 0: none.
  uint16_t crc_ = 0;
};

inline void SerialPort::byte_received(uint8_t byte) {
  if (!on_) return;
  HdlcDeframer& receiver = receivers_[filling_];
  if (receiver.push(byte) != HdlcEvent::kFrame) return;
  const Bytes content = receiver.content();
  const uint8_t kind = content[0];
  if (kind != kSerialPacketAck && kind != kSerialPacketNoAck) return;
  if (ready_ != kNone) return;  // Unconfirmed, so that a host sends it again.
  if (kind == kSerialPacketAck) {
    ack_seq_ = content[1];
    ack_pending_ = true;
    start_sending();
  }
  ready_ = filling_;
  filling_ = filling_ == 0 ? 1 : 0;
}

inline uint8_t SerialPort::poll(Node& node) {
  on_ = node.interface_is_on(Line::kSerial);
  if (sent_) {
    sent_ = false;
    node.sent(Line::kSerial, false);
  }
  if (ready_ == kNone) return 0;
  const Bytes content = receivers_[ready_].content();
  const size_t header = serial_kind_has_seq(content[0]) ? 2 : 1;
  node.received(Line::kSerial, content.from(header));
  ready_ = kNone;
  return 1;
}

inline void SerialPort::send(Bytes packet) {
  packet_ = packet.data();
  packet_size_ = static_cast<uint8_t>(packet.size());
  start_sending();
}

inline void SerialPort::set_held(bool held) {
  held_ = held;
  if (!held) start_sending();
}

inline bool SerialPort::begin_frame() {
  if (!ack_pending_ && packet_size_ == 0) return false;
  sending_ack_ = ack_pending_;
  position_ = 0;
  crc_ = 0;
  step_ = Step::kKind;
  return true;
}

inline void SerialPort::end_frame() {
  step_ = Step::kIdle;
  if (sending_ack_) {
    ack_pending_ = false;
  } else {
    packet_size_ = 0;
    sent_ = true;
  }
}

inline uint8_t SerialPort::body_byte() {
  const uint8_t byte = sending_ack_ ? ack_seq_ : packet_[position_];
  const uint8_t size = sending_ack_ ? uint8_t{1} : packet_size_;
  if (++position_ == size) step_ = Step::kCrcLow;
  return byte;
}

inline uint8_t SerialPort::escaped(uint8_t byte) {
  if (byte != kHdlcFlag && byte != kHdlcEscape) return byte;
  behind_escape_ = static_cast<uint8_t>(byte ^ kHdlcXor);
  return kHdlcEscape;
}

inline uint8_t SerialPort::counted(uint8_t byte) {
  crc_ = crc16_step(crc_, byte);
  return escaped(byte);
}

inline bool SerialPort::next_byte(uint8_t& byte) {
  if (held_) return false;
  if (behind_escape_ != 0) {
    byte = behind_escape_;
    behind_escape_ = 0;
    return true;
  }
  switch (step_) {
    case Step::kIdle:
      if (!begin_frame()) return false;
      byte = kHdlcFlag;
      return true;
    case Step::kKind:
      step_ = Step::kBody;
      byte = counted(sending_ack_ ? kSerialAck : kSerialPacketNoAck);
      return true;
    case Step::kBody: byte = counted(body_byte()); return true;
    case Step::kCrcLow:
      byte = escaped(static_cast<uint8_t>(crc_));
      step_ = Step::kCrcHigh;
      return true;
    case Step::kCrcHigh:
      byte = escaped(static_cast<uint8_t>(crc_ >> 8));
      step_ = Step::kClose;
      return true;
    case Step::kClose:
      byte = kHdlcFlag;  // The next frame opens with its own: two flags separate frames.
      end_frame();
      return true;
  }
  return false;
}

}  // namespace node
}  // namespace rubric
