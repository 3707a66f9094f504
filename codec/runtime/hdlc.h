// Frames of the TinyOS serial line, one byte at a time: enough for a mote to send and receive.
// Hosts read with codec/containers/hdlc_reader.h.
#pragma once

#include "codec/runtime/bytes.h"
#include "codec/runtime/crc16.h"
#include "codec/runtime/result.h"

namespace rubric {

constexpr uint8_t kHdlcFlag = 0x7E;
constexpr uint8_t kHdlcEscape = 0x7D;
constexpr uint8_t kHdlcXor = 0x20;  ///< Escaped bytes are combined with it.

/// The packet kinds of TEP 113, section 3.1. Any other value is kept, too.
constexpr uint8_t kSerialAck = 0x43;
constexpr uint8_t kSerialPacketAck = 0x44;
constexpr uint8_t kSerialPacketNoAck = 0x45;
constexpr uint8_t kSerialUnknown = 0xFF;

/// Returns whether a sequence number follows the packet kind.
constexpr bool serial_kind_has_seq(int kind) {
  return kind == kSerialAck || kind == kSerialPacketAck;
}

constexpr size_t kSerialCrcBytes = 2;
/// Kind, one more byte, CRC: hosts ignore shorter frames (WIRE-HDLC-SHORT).
constexpr size_t kSerialContentMin = 4;
/// Bytes after kind and sequence number, CRC included (WIRE-HDLC-LONG).
constexpr size_t kSerialAfterHeaderMax = 254;

/// Returns the longest content (kind to CRC) that a frame of this kind may have, in bytes.
constexpr size_t serial_content_max(int kind) {
  return kSerialAfterHeaderMax + (serial_kind_has_seq(kind) ? 2 : 1);
}

/// Returns room that surely holds the frame of `content_bytes` bytes (kind to CRC): all of them
/// escaped.
constexpr size_t hdlc_frame_room(size_t content_bytes) { return 2 * content_bytes + 2; }

/// Writes a frame piece by piece: open, put..., close.
class HdlcFramer {
 public:
  explicit HdlcFramer(MutableBytes out) : out_(out) {}

  void open() { raw(kHdlcFlag); }

  /// Writes a byte of the content, escaped where it must be, and counts it into the CRC.
  void put(uint8_t byte) {
    crc_ = crc16_step(crc_, byte);
    escaped(byte);
  }
  void put(Bytes bytes) {
    for (size_t i = 0; i < bytes.size(); ++i) put(bytes[i]);
  }

  /// Writes the CRC and the closing flag. Returns the size of the whole frame in bytes, or
  /// Fault::kNoRoom at the size of the output.
  Result<size_t> close() {
    const uint16_t crc = crc_;
    escaped(static_cast<uint8_t>(crc));
    escaped(static_cast<uint8_t>(crc >> 8));
    raw(kHdlcFlag);
    if (full_) return fail(Fault::kNoRoom, out_.size(), "WIRE-HDLC-FLAG"_rule);
    return used_;
  }

 private:
  void raw(uint8_t byte) {
    if (used_ < out_.size()) {
      out_[used_++] = byte;
    } else {
      full_ = true;
    }
  }
  void escaped(uint8_t byte) {
    if (byte == kHdlcFlag || byte == kHdlcEscape) {
      raw(kHdlcEscape);
      byte = static_cast<uint8_t>(byte ^ kHdlcXor);
    }
    raw(byte);
  }

  MutableBytes out_;
  size_t used_ = 0;
  uint16_t crc_ = 0;
  bool full_ = false;
};

/// Writes a whole frame (flag, escaped content and CRC, flag) around `content`, which begins with
/// the kind byte and lacks the CRC. Returns the frame's size in bytes. Errors: kTooLong (beyond
/// serial_content_max), kNoRoom. Source: TEP 113, section 3.1.
inline Result<size_t> write_hdlc_frame(Bytes content, MutableBytes out) {
  const size_t max = serial_content_max(content.empty() ? 0 : content[0]) - kSerialCrcBytes;
  if (content.size() > max) return fail(Fault::kTooLong, max, "WIRE-HDLC-LONG"_rule);
  HdlcFramer framer(out);
  framer.open();
  framer.put(content);
  return framer.close();
}

/// Writes the frame of a packet (from its dispatch byte on) that asks for no confirmation, as motes
/// send.
inline Result<size_t> write_serial_packet(Bytes packet, MutableBytes out) {
  const size_t max = kSerialAfterHeaderMax - kSerialCrcBytes;
  if (packet.size() > max) return fail(Fault::kTooLong, 1 + max, "WIRE-HDLC-LONG"_rule);
  HdlcFramer framer(out);
  framer.open();
  framer.put(kSerialPacketNoAck);
  framer.put(packet);
  return framer.close();
}

/// Writes the frame of a packet whose sender wants it confirmed under `seq`, as hosts send.
inline Result<size_t> write_serial_packet_ack(uint8_t seq, Bytes packet, MutableBytes out) {
  const size_t max = kSerialAfterHeaderMax - kSerialCrcBytes;
  if (packet.size() > max) return fail(Fault::kTooLong, 2 + max, "WIRE-HDLC-LONG"_rule);
  HdlcFramer framer(out);
  framer.open();
  framer.put(kSerialPacketAck);
  framer.put(seq);
  framer.put(packet);
  return framer.close();
}

/// Writes the frame that confirms the packet sent under `seq`.
inline Result<size_t> write_serial_ack(uint8_t seq, MutableBytes out) {
  const uint8_t content[] = {kSerialAck, seq};
  return write_hdlc_frame(content, out);
}

/// The effect of a byte on a HdlcDeframer.
enum class HdlcEvent : uint8_t {
  kNone,   ///< Nothing yet.
  kFrame,  ///< An intact frame: see content().
  kBad,    ///< A malformed one: see error().
};

/// Finds frames in a stream of bytes. The caller lends the buffer; its size bounds what is kept.
/// Constant work per byte, so that it may run in a receive interrupt.
class HdlcDeframer {
 public:
  explicit HdlcDeframer(MutableBytes buffer) : buffer_(buffer) {}

  /// Takes a byte. content() and error() are valid from an event to the next push.
  HdlcEvent push(uint8_t byte) {
    if (done_) restart();
    if (byte == kHdlcFlag) return flag();
    if (byte == kHdlcEscape && !escaping_) {
      escaping_ = true;
      return HdlcEvent::kNone;
    }
    if (escaping_) byte = static_cast<uint8_t>(byte ^ kHdlcXor);
    escaping_ = false;
    add(byte);
    return HdlcEvent::kNone;
  }

  /// Returns kind byte to the last byte before the CRC; for a bad frame, everything that was kept
  /// of it.
  Bytes content() const { return Bytes(buffer_.data(), content_size_); }
  const Error& error() const { return error_; }

 private:
  void restart() {
    size_ = 0;
    crc_ = 0;
    escaping_ = false;
    too_long_ = false;
    done_ = false;
  }

  void add(uint8_t byte) {
    if (size_ >= buffer_.size()) {
      too_long_ = true;
      return;
    }
    buffer_[size_++] = byte;
    // Two bytes late, since the last two of the frame are the CRC itself.
    if (size_ > kSerialCrcBytes) crc_ = crc16_step(crc_, buffer_[size_ - 1 - kSerialCrcBytes]);
  }

  HdlcEvent flag() {
    if (size_ == 0 && !escaping_ && !too_long_) return HdlcEvent::kNone;  // Idle line.
    done_ = true;
    content_size_ = size_;
    if (escaping_) return bad(Fault::kAborted, size_, "WIRE-HDLC-ESCAPE"_rule);
    const size_t max = size_ == 0 ? 0 : serial_content_max(buffer_[0]);
    if (size_ > max) return bad(Fault::kTooLong, max, "WIRE-HDLC-LONG"_rule);
    if (too_long_) return bad(Fault::kTooLong, size_, "WIRE-HDLC-LONG"_rule);
    if (size_ < kSerialContentMin) return bad(Fault::kTooShort, size_, "WIRE-HDLC-SHORT"_rule);
    const size_t crc_at = size_ - kSerialCrcBytes;
    if (load_le16(buffer_.data() + crc_at) != crc_) {
      return bad(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule);
    }
    content_size_ = crc_at;
    error_ = Error{Fault::kNone, 0, ReqId::kNone};
    return HdlcEvent::kFrame;
  }

  HdlcEvent bad(Fault fault, size_t offset_bytes, ReqId requirement) {
    error_ = Error{fault, static_cast<uint32_t>(offset_bytes), requirement};
    return HdlcEvent::kBad;
  }

  MutableBytes buffer_;
  size_t size_ = 0;
  size_t content_size_ = 0;
  uint16_t crc_ = 0;
  bool escaping_ = false;
  bool too_long_ = false;
  bool done_ = false;
  Error error_{Fault::kNone, 0, ReqId::kNone};
};

}  // namespace rubric
