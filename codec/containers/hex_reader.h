// Packets as lines of hex text, as TinyOS's Listen prints them.
#pragma once

#include <vector>

#include "codec/containers/reader.h"

namespace rubric {

/// The most characters of a line that are kept.
inline constexpr std::size_t kHexLineMax = 64 * 1024;

/// Reads a packet a line: two hex digits of either case for each byte, with or without white space
/// between bytes, each byte or run of bytes optionally led by 0x. Skips empty lines and everything
/// after a '#'. An option gives the framing of the lines (hex_framing).
///
/// Faults: kUnexpected (a line that is no hex text: the line itself is delivered, the offset counts
/// its characters), kTooLong (a line beyond kHexLineMax), kCut never: the last line needs no end;
/// and those of the framing, whose offsets count the bytes of the packet.
/// Source: TinyOS Listen tool.
class HexReader final : public Reader {
 public:
  explicit HexReader(const ReaderOptions& options = {});

  void feed(Bytes chunk, PacketSink sink) override;
  void finish(PacketSink sink) override;

 private:
  void hold(Bytes text);
  void line(Bytes text, PacketSink sink);
  void deliver_held(PacketSink sink);

  ReaderOptions options_;
  std::uint64_t line_offset_ = 0;
  std::uint64_t dropped_ = 0;
  std::vector<std::uint8_t> held_;   // The beginning of a line that spans chunks.
  std::vector<std::uint8_t> bytes_;  // The present line, decoded.
};

/// Decodes one line into `bytes`, which is cleared first. The error's offset counts characters.
Error decode_hex_line(Bytes text, std::vector<std::uint8_t>& bytes);

}  // namespace rubric
