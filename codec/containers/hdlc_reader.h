// Finds the frames in the bytes of a serial line.
#pragma once

#include <array>
#include <cstdint>

#include "codec/containers/byte_search.h"
#include "codec/containers/reader.h"

namespace rubric {

/// The most bytes of a frame's content that are kept; the rest is counted in dropped_bytes.
inline constexpr std::size_t kHdlcKeptMax = 4096;

/// A streaming deframer: any split of the input gives the same packets.
///
/// Every flag ends the frame before it and opens the next one, whatever came before, so one damaged
/// frame never costs the next intact one. Flags in a row are idle time. Bytes before the first flag
/// are treated as a frame, too: a capture may begin in the middle of one. A frame that lies in one
/// chunk without escapes is delivered in place, any other from a buffer.
///
/// Faults (offsets count in the unescaped content from the kind byte): kAborted, kTooLong,
/// kTooShort, kCrc, kCut, looked for in this order, kCut first at the end of the input. An unknown
/// kind is no fault. serial_frame.h explains how the pieces of a malformed frame are filled in.
/// Source: TEP 113, section 3.1; RFC 1662, section 4.
class HdlcReader final : public Reader {
 public:
  explicit HdlcReader(const ReaderOptions& options = {}, CpuPath path = best_cpu_path());

  void feed(Bytes chunk, PacketSink sink) override;
  void finish(PacketSink sink) override;

 private:
  template <CpuPath kPath>
  void feed_with(Bytes chunk, PacketSink sink);
  template <CpuPath kPath>
  void hold(const std::uint8_t* begin, const std::uint8_t* end);
  template <CpuPath kPath>
  void deliver(Bytes content, PacketSink sink);
  void deliver_usual(Bytes content, std::uint16_t crc_wanted, PacketSink sink);
  void deliver_damaged(Bytes content, const Error& error, PacketSink sink);
  template <CpuPath kPath>
  void deliver_held(PacketSink sink);
  void restart();

  CpuPath path_;
  Packet packet_;                   // The fields that are the same for all stay filled in.
  std::uint64_t chunk_offset_ = 0;  // Offset of the present chunk in the input.
  // The frame that an earlier chunk began or that has escapes, unescaped.
  bool open_ = false;
  bool escaping_ = false;  // Its last byte so far was an escape.
  std::size_t held_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t open_offset_ = 0;
  std::array<std::uint8_t, kHdlcKeptMax + kUnescapeSlack> buffer_;
};

}  // namespace rubric
