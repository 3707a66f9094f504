// Property: any split of a pcap file gives the same packets, one for each record that a plain loop
// finds, all at their stated places in the file; their output reads back as the same.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "codec/containers/link_record.h"
#include "codec/containers/pcap_reader.h"
#include "codec/containers/zep_packet.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

// Counts the records of a file that begins with a sound header; bytes after a damaged one are no
// record.
std::size_t count_records(Bytes file, bool* rest) {
  const bool big = file[0] == 0xA1;
  std::size_t at = 24;
  std::size_t count = 0;
  for (; file.size() - at >= 16; ++count) {
    const std::uint8_t* const p = file.data() + at + 8;
    const std::size_t captured = big ? load_be32(p) : load_le32(p);
    if (captured > kCaptureRecordMax || captured > file.size() - at - 16) break;
    at += 16 + captured;
  }
  *rest = at != file.size();
  return count;
}

bool has_header(Bytes file) {
  if (file.size() < 24) return false;
  const std::uint32_t big = load_be32(file.data());
  const std::uint32_t little = load_le32(file.data());
  return big == 0xA1B2C3D4 || big == 0xA1B23C4D || little == 0xA1B2C3D4 || little == 0xA1B23C4D;
}

void check_writer(const std::vector<Kept>& packets, std::uint16_t link_type) {
  PcapWriter writer(link_type);
  std::string written;
  writer.begin(written);
  std::vector<Kept> wanted;
  // Something is taken off before these frames, so that they go under another link type.
  const bool changes = link_type == kLinkRadioTap || link_type == kLinkRadioPhy ||
                       link_type == kLinkRadioLinux || is_network_link(link_type);
  for (const Kept& kept : packets) {
    if (!writer.write(kept.get(), written)) {
      require(kept.packet.link_type == 0 || changes,
              "every record of a file can be written to one");
      continue;
    }
    wanted.push_back(fuzz::placeless(kept));
    // If seconds and ticks are both out of range, there is no room for the sum.
    std::int64_t& time_ns = wanted.back().packet.time_ns;
    time_ns = std::min<std::int64_t>(time_ns, 4294967295'999999999);
  }
  PcapReader reader;
  std::vector<Kept> again = testing::read_all(reader, testing::view(written));
  for (Kept& kept : again) kept = fuzz::placeless(kept);
  fuzz::require_same(again, wanted, "what is written reads back as the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes file(data, size);
  const auto make = [] { return std::make_unique<PcapReader>(); };
  const std::vector<Kept> packets = fuzz::read_in_any_pieces(make, file);
  fuzz::require_in_place(packets, file);
  if (!has_header(file)) {
    require(packets.size() == 1, "what is not a file is one damage");
    return 0;
  }
  bool rest = false;
  const std::size_t records = count_records(file, &rest);
  require(packets.size() == records + rest, "a packet a record, and one for damage at the end");
  const std::uint16_t link_type = data[0] == 0xA1 ? load_be16(data + 22) : load_le16(data + 20);
  check_writer(packets, link_type);
  return 0;
}
