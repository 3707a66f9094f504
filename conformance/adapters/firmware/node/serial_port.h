// The TinyOS serial stack of a mote over any UART: HDLC-like frames, CRC, confirmations.
// (TEP 113)
#pragma once

#include "codec/runtime/hdlc.h"
#include "conformance/adapters/firmware/node/node.h"

namespace rubric {
namespace firmware {

/// Handles a byte at a time, in the UART's interrupts or in place of them.
class SerialPort : public SerialLine {
 public:
  SerialPort() : receivers_{HdlcDeframer(contents_[0]), HdlcDeframer(contents_[1])} {}

  // From the UART's interrupts.

  void byte_received(uint8_t byte);
  /// Sets the next byte to send; returns false if there is none. start_sending() is called when
  /// there is one again.
  bool next_byte(uint8_t& byte);

  // From the main loop.

  void send(Bytes packet) override;
  void set_on(bool on) override { on_ = on; }
  /// Notes that the other side takes no bytes now, or takes them again: clear to send.
  void set_held(bool held);
  /// Returns whether poll has something to do.
  bool has_news() const { return ready_ != kNone || sent_; }
  /// Passes arrived packets and ends of transmissions to the node; returns the number of packets.
  uint8_t poll(Node& node);
  bool is_sending() const { return packet_size_ != 0 || ack_pending_; }

 protected:
  /// Makes the UART ask for bytes, if it does not.
  virtual void start_sending() = 0;
  ~SerialPort() = default;

 private:
  enum : uint8_t { kNone = 0xFF };
  enum class Step : uint8_t { kIdle, kKind, kBody, kCrcLow, kCrcHigh, kClose };
  // Kind, sequence number, packet, CRC.
  static constexpr size_t kContentMax = 2 + kAmHeaderBytes + kAmPayloadMax + kSerialCrcBytes;

  bool begin_frame();
  void end_frame();
  uint8_t body_byte();
  uint8_t escaped(uint8_t byte);
  uint8_t counted(uint8_t byte);

  uint8_t contents_[2][kContentMax];
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

}  // namespace firmware
}  // namespace rubric
