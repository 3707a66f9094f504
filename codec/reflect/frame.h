// Decodes packets: the TinyOS frames (serial packet, 802.15.4) around the messages of a protocol.
#pragma once

#include <cstdint>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/reflect/decode.h"

namespace rubric::reflect {

/// The active-message header, wherever it was read from. On the radio length counts the bytes after
/// the AM type and group is the low byte of the PAN.
struct ActiveMessage {
  bool present = false;
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
  std::uint16_t length = 0;
  std::uint8_t group = 0;
  std::uint8_t type = 0;
};

/// The 802.15.4 header of a radio frame. An acknowledgement has fcf and dsn only.
struct MacHeader {
  bool present = false;
  bool has_addresses = false;
  bool has_network = false;  ///< I-frame.
  std::uint16_t fcf = 0;
  std::uint8_t dsn = 0;
  std::uint8_t network = 0;  ///< Where has_network.
  std::uint16_t destpan = 0;
  std::uint16_t dest = 0;
  std::uint16_t src = 0;
};

/// A packet taken apart down to its active message, whose own bytes nobody has looked at yet.
struct Envelope {
  enum class Kind : std::uint8_t {
    kNothing,  ///< Too short for a kind.
    kOpaque,   ///< Of a kind that carries no message known here, such as a secured radio frame.
    kLinkAck,  ///< An acknowledgement of the serial line or of 802.15.4.
    kMessage,  ///< A frame of `carrier`.
    kLink,     ///< Another frame of 802.15.4: a beacon or a command.
    kBare,     ///< The message alone.
  };
  Kind kind = Kind::kNothing;
  std::int64_t key = 0;  ///< kOpaque: the kind of the packet, or the frame control field.
  ActiveMessage am;
  MacHeader mac;
  const Type* carrier = nullptr;  ///< kMessage, kLink, acknowledgements of 802.15.4.
  bool is_am = false;             ///< kMessage: the headers of `carrier` are TinyOS's.
  Bytes payload;                  ///< kMessage without an error: that of the active message.
  /// Of the framing, else of the headers; those of the message are not known yet.
  Error error{Fault::kNone, 0, ReqId::kNone};
};

/// Returns the choice of the messages in this carrier's frames; null if it has none. Traces and
/// adapters write a radio frame as a serial packet with a message of the radio's (rct/1).
const Switch* payload_choice(const Protocol& protocol, std::string_view carrier);

/// Returns whether frames of this carrier are TinyOS's: its headers, under the names of
/// `spec/wire`, and then the payload. Other frames are shown and written with all of their fields,
/// as a message.
bool has_tinyos_headers(const Type& carrier);

/// A decoded packet. `packet` and the bytes are borrowed.
struct Frame {
  const Packet* packet = nullptr;
  Decoded decoded;  ///< Empty (no nodes) where the bytes are not a message.
  /// Node of the outermost message's fields; 0 if bare, or where the carrier's headers are its own.
  std::uint32_t payload_node = 0;
  bool has_payload = false;  ///< payload_node names a structure or opaque bytes.
  ActiveMessage am;
  MacHeader mac;
  /// The fault of the framing, else of the content. The offset counts from the first byte of
  /// packet->bytes; a fault of the frame's check sum is right after them.
  Error error{Fault::kNone, 0, ReqId::kNone};
  bool has_error() const { return error.fault != Fault::kNone; }
  /// Returns whether the error is the sender's or the channel's: what a capture's snap length cuts
  /// off says nothing of the frame.
  bool malformed() const { return has_error() && !(packet && packet->cut_by_capture()); }
};

/// Decodes packets by one protocol's tables.
class FrameDecoder {
 public:
  /// `bare`: the type of packets with Framing::kBare; null if there will be none.
  explicit FrameDecoder(const Protocol& protocol, const Type* bare = nullptr);

  /// Decodes `packet` into `out`, which borrows it. Reuse `out`.
  void decode(const Packet& packet, Frame& out) const;
  /// Reads the headers alone, as decode() does, for who reads the message by its generated view.
  Envelope open(const Packet& packet) const;

  const Protocol& protocol() const { return protocol_; }

 private:
  // Where a radio carrier's frames have the AM type and the message; found once, as most frames of
  // a capture are such.
  struct RadioCarrier {
    explicit RadioCarrier(const Type* carrier);
    const Type* type;
    std::size_t type_at = 0;
    std::size_t payload_at = 0;
    std::int64_t network = -1;  ///< The value of the byte after the 802.15.4 header; -1: any.
    bool is_am = true;          ///< Its headers are TinyOS's.
  };

  void headers(const Packet& packet, Envelope& out) const;
  void serial_headers(Bytes bytes, Envelope& out) const;
  void radio_headers(Bytes bytes, Envelope& out) const;
  void decode_carrier(const Type& carrier, Bytes bytes, Decoded& out) const;
  const Type* link_carrier(std::uint16_t fcf) const;
  Error fault_of(const Type& carrier, Bytes bytes) const;

  const Protocol& protocol_;
  const Type* bare_;
  const Type* serial_;
  bool serial_is_am_;  ///< Its headers are TinyOS's.
  RadioCarrier radio_i_;
  RadioCarrier radio_t_;
  const Type* radio_ack_;
  const Type* radio_beacon_;
  const Type* radio_command_;
  const Switch* radio_choice_;
};

}  // namespace rubric::reflect
