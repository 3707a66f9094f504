// A packet from a container or a line: its bytes, and everything that the bytes lack.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "codec/runtime/bytes.h"
#include "codec/runtime/result.h"

namespace rubric {

/// The framing of a packet, which decides how its bytes begin.
enum class Framing : std::uint8_t {
  kHdlc,   ///< Serial line; bytes from the dispatch byte on.
  kSf,     ///< Serial forwarder; bytes from the dispatch byte on.
  kRadio,  ///< 802.15.4; bytes from the frame control field on, FCS excluded.
  kBare,   ///< A message alone.
};

enum class Direction : std::uint8_t { kUnknown, kInbound, kOutbound };

inline constexpr std::int64_t kNoTime = INT64_MIN;
inline constexpr std::int32_t kAbsent = -1;

/// Facts about a radio frame that its sniffer states beside the bytes.
struct RadioFacts {
  std::optional<float> rssi;    ///< dBm in a TAP header; as the chip reads it in a CC24xx trailer.
  std::int64_t slot = kAbsent;  ///< Absolute slot number.
  std::int32_t channel = kAbsent;
  std::int16_t lqi = kAbsent;
  std::uint8_t page = 0;  ///< Of the channel.
  bool more = false;      ///< There are facts that are not kept here, such as the bit rate.

  /// Returns whether there is one that is kept.
  bool any() const { return rssi || slot != kAbsent || channel != kAbsent || lqi != kAbsent; }
  bool operator==(const RadioFacts&) const = default;
};

/// One packet. `bytes` belong to the reader and live until the callback returns.
struct Packet {
  Framing framing = Framing::kBare;
  Direction direction = Direction::kUnknown;
  Bytes bytes;
  /// Where its frame begins in the input: the first byte after the flag, the length byte, the
  /// frame control field, the record's data or the line. Errors count from there.
  std::uint64_t offset_bytes = 0;
  std::int64_t time_ns = kNoTime;  ///< Since the epoch of the input, or kNoTime.
  std::uint32_t interface_id = 0;  ///< Index into the reader's interfaces().
  /// LINKTYPE_ of a capture file, 0 elsewhere. That of the radio frame alone where something else
  /// was taken off before it (a UDP datagram, a preamble).
  std::uint16_t link_type = 0;
  // Serial line (kHdlc): the parts around `bytes`; kAbsent if the frame was too short for one.
  std::int32_t kind = kAbsent;        ///< Packet kind.
  std::int32_t serial_seq = kAbsent;  ///< Sequence number; only kinds ACK and PACKET_ACK have one.
  std::int32_t crc = kAbsent;         ///< As received.
  // Radio (kRadio).
  std::int32_t fcs = kAbsent;  ///< As received; kAbsent where the capture has none.
  RadioFacts radio;
  std::uint64_t line = 0;    ///< Of hex text, from 1; 0 elsewhere.
  std::string_view comment;  ///< The capture file's; lives as long as `bytes`.
  /// The fault of the framing itself; kNone if it is sound. Its offset counts from the first byte
  /// of the frame (kind byte, length byte or frame control field).
  Error error{Fault::kNone, 0, ReqId::kNone};
  /// Number of bytes of the packet that are not in `bytes`: it grew beyond every bound
  /// (Fault::kTooLong), the capture kept only its beginning (Fault::kCut), or they could not be
  /// read at all (Fault::kContainer).
  std::uint64_t dropped_bytes = 0;

  /// Returns whether only the capture's snap length is to blame for the error.
  bool cut_by_capture() const { return error.fault == Fault::kCut && link_type != 0; }
  /// Returns whether `fcs` is not one: a CC24xx chip puts RSSI and link quality there.
  bool has_cc24xx_trailer() const {
    return fcs != kAbsent && radio.rssi == static_cast<std::int8_t>(fcs & 0xFF) &&
           radio.lqi == (fcs >> 8 & 0x7F);
  }
};

/// A callback for packets: a plain pair, so that calling it costs no more than a function pointer.
class PacketSink {
 public:
  template <class F>
  requires(!std::is_same_v<F, PacketSink>)  // Copies must not call through one another.
      PacketSink(F& call)  // NOLINT: a borrowed view of a callable, as std::function_ref will be.
      : object_(&call),
        call_([](void* object, const Packet& packet) { (*static_cast<F*>(object))(packet); }) {}
  void operator()(const Packet& packet) const { call_(object_, packet); }

 private:
  void* object_;
  void (*call_)(void*, const Packet&);
};

}  // namespace rubric
