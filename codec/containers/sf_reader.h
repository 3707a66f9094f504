// Reads packets of one direction of a serial forwarder connection.
#pragma once

#include "codec/containers/unit_reader.h"

namespace rubric {

inline constexpr std::uint8_t kSfMagic = 0x55;    ///< 'U', the first byte of the handshake.
inline constexpr std::uint8_t kSfVersion = 0x20;  ///< The lowest version there is.
inline constexpr std::size_t kSfPacketMax = 255;  ///< The largest length byte.

/// Reads the handshake, then packets of a length byte and that many bytes.
///
/// Faults: kHandshake (the bytes at fault are delivered, then read as if the stream had begun with
/// packets), kEmpty (a length of 0), kCut. Offsets count from the length byte.
/// Source: TinyOS serial forwarder protocol, version 2.
class SfReader final : public UnitReader {
 public:
  explicit SfReader(const ReaderOptions& options = {});

 protected:
  Step step(Bytes input, PacketSink sink) override;
  void end(Bytes rest, PacketSink sink) override;

 private:
  void deliver(Bytes bytes, std::size_t size_bytes, const Error& error, PacketSink sink);

  Packet packet_;
  bool greeted_ = false;
};

}  // namespace rubric
