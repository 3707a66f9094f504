// The pcap capture file format.
#pragma once

#include "codec/containers/unit_reader.h"

namespace rubric {

/// A captured packet beyond this size is taken for damage.
inline constexpr std::size_t kCaptureRecordMax = 256 * 1024;

/// Reads both byte orders, microseconds and nanoseconds.
///
/// Faults: kContainer (no pcap file, or a record with an impossible length; the format has no mark
/// to find the next record by, so all later bytes are counted in dropped_bytes), kCut (the file
/// ends within its header or a record), and those of link_record.h. Offsets of the first two count
/// from the header at fault. Source: draft-ietf-opsawg-pcap.
class PcapReader final : public UnitReader {
 public:
  explicit PcapReader(const ReaderOptions& options = {}) : options_(options) {}

 protected:
  Step step(Bytes input, PacketSink sink) override;
  void end(Bytes rest, PacketSink sink) override;

 private:
  Step file_header(Bytes input);
  Step damage(Bytes header, std::uint32_t offset_bytes);
  std::uint32_t load32(const std::uint8_t* p) const {
    return big_endian_ ? load_be32(p) : load_le32(p);
  }

  ReaderOptions options_;
  bool big_endian_ = false;
  bool has_header_ = false;
  Packet damage_;  // Delivered at the end of the input, when its extent is known.
  std::uint8_t damaged_header_[24] = {};
  bool damaged_ = false;
};

}  // namespace rubric
