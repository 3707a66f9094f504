#include "conformance/adapters/firmware/node/serial_port.h"

namespace rubric {
namespace firmware {

constexpr size_t SerialPort::kContentMax;

void SerialPort::byte_received(uint8_t byte) {
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

uint8_t SerialPort::poll(Node& node) {
  if (sent_) {
    sent_ = false;
    node.serial_sent();
  }
  if (ready_ == kNone) return 0;
  const Bytes content = receivers_[ready_].content();
  const size_t header = serial_kind_has_seq(content[0]) ? 2 : 1;
  node.serial_received(content.from(header));
  ready_ = kNone;
  return 1;
}

void SerialPort::send(Bytes packet) {
  packet_ = packet.data();
  packet_size_ = static_cast<uint8_t>(packet.size());
  start_sending();
}

void SerialPort::set_held(bool held) {
  held_ = held;
  if (!held) start_sending();
}

bool SerialPort::begin_frame() {
  if (!ack_pending_ && packet_size_ == 0) return false;
  sending_ack_ = ack_pending_;
  position_ = 0;
  crc_ = 0;
  step_ = Step::kKind;
  return true;
}

void SerialPort::end_frame() {
  step_ = Step::kIdle;
  if (sending_ack_) {
    ack_pending_ = false;
  } else {
    packet_size_ = 0;
    sent_ = true;
  }
}

uint8_t SerialPort::body_byte() {
  const uint8_t byte = sending_ack_ ? ack_seq_ : packet_[position_];
  const uint8_t size = sending_ack_ ? uint8_t{1} : packet_size_;
  if (++position_ == size) step_ = Step::kCrcLow;
  return byte;
}

uint8_t SerialPort::escaped(uint8_t byte) {
  if (byte != kHdlcFlag && byte != kHdlcEscape) return byte;
  behind_escape_ = static_cast<uint8_t>(byte ^ kHdlcXor);
  return kHdlcEscape;
}

uint8_t SerialPort::counted(uint8_t byte) {
  crc_ = crc16_step(crc_, byte);
  return escaped(byte);
}

bool SerialPort::next_byte(uint8_t& byte) {
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

}  // namespace firmware
}  // namespace rubric
