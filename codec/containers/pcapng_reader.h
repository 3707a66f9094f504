// The pcapng capture file format.
#pragma once

#include <array>
#include <optional>

#include "codec/containers/pcap_reader.h"

namespace rubric {

/// A block beyond this size is taken for damage.
inline constexpr std::size_t kPcapngBlockMax = 16 * 1024 * 1024;

/// Reads both byte orders, any number of sections, interfaces of any link types; enhanced, simple
/// and obsolete packet blocks with their time, direction and comment. Skips other blocks.
/// interfaces() counts on over the sections.
///
/// Faults, all with offsets from the block's first byte and framing kBare: kContainer (a damaged
/// block; its header of 12 bytes is delivered, the search for the next sound block continues after
/// it, dropped_bytes counts the skipped bytes; or a sound block whose content does not fit it,
/// delivered whole), kUnsupported (a section of another major version, skipped), kCut (the file
/// ends within a block; its part is delivered). Packets may have those of link_record.h. Source:
/// draft-ietf-opsawg-pcapng.
class PcapngReader final : public UnitReader {
 public:
  explicit PcapngReader(const ReaderOptions& options = {}) : options_(options) {}

 protected:
  Step step(Bytes input, PacketSink sink) override;
  void end(Bytes rest, PacketSink sink) override;

 private:
  struct Option {
    std::uint16_t code;
    Bytes value;
  };
  struct Captured {  // The common part of the three kinds of packet block.
    std::size_t interface;
    std::optional<std::uint64_t> ticks;
    std::size_t data_at;
    std::size_t captured_bytes;
    std::uint64_t original_bytes;
    bool has_options;
  };

  std::optional<std::size_t> plausible_block(Bytes input, bool* big_endian) const;
  std::size_t find_block(Bytes input, std::size_t* wanted) const;
  Step search(Bytes input, PacketSink sink);
  Step damage(Bytes header, std::uint32_t offset_bytes);
  void deliver_damage(PacketSink sink);
  void deliver_bad_block(Bytes block, Fault fault, std::size_t at, PacketSink sink);
  void block(Bytes block, PacketSink sink);
  void section(Bytes block, PacketSink sink);
  void interface_description(Bytes block, PacketSink sink);
  void packet_block(Bytes block, std::uint32_t type, PacketSink sink);
  void deliver(Bytes block, const Captured& captured, PacketSink sink);
  bool next_option(Bytes& options, Option* option, bool* sound) const;

  std::uint16_t load16(const std::uint8_t* p) const {
    return big_endian_ ? load_be16(p) : load_le16(p);
  }
  std::uint32_t load32(const std::uint8_t* p) const {
    return big_endian_ ? load_be32(p) : load_le32(p);
  }

  ReaderOptions options_;
  bool big_endian_ = false;
  bool in_section_ = false;
  bool supported_ = true;                    // The section's major version is known.
  bool final_ = false;                       // No more input will come.
  std::size_t first_interface_ = 0;          // Begin of the present section in interfaces_.
  std::vector<std::uint32_t> snap_lengths_;  // For the present section's interfaces.
  bool damaged_ = false;
  Packet damage_;  // Delivered when the next sound block is found.
  std::array<std::uint8_t, 12> damaged_header_{};
};

}  // namespace rubric
