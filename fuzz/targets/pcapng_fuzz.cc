// Property: any split of a pcapng file gives the same packets and interfaces, all at their stated
// places in the file; sound blocks are those that a plain walk finds; their output reads back as
// the same.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "codec/containers/link_record.h"
#include "codec/containers/pcapng_reader.h"
#include "codec/containers/zep_packet.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

// Names and packets side by side.
struct File {
  std::vector<Kept> packets;
  std::vector<std::string> names;
};

File with_names(const Reader& reader, std::vector<Kept> packets) {
  File file;
  for (const Kept& kept : packets) {
    file.names.emplace_back(fuzz::interface_name(reader, kept.packet));
    file.packets.push_back(fuzz::placeless(kept));
  }
  return file;
}

struct Walked {
  std::size_t data_at;
  std::size_t interface;
  std::uint16_t link_type;
};

// Returns whether something before the frame is taken off: a header, a preamble, a datagram.
bool has_head(std::uint16_t link_type) {
  return link_type == kLinkRadioTap || link_type == kLinkRadioPhy || is_network_link(link_type);
}

// Returns the enhanced packets of a little-endian file of whole blocks of the usual kinds only;
// nothing for any other file.
std::vector<Walked> plain_walk(Bytes file) {
  std::vector<Walked> packets;
  std::vector<std::uint16_t> links;
  std::size_t first = 0;  // Interface of the present section.
  std::size_t next = 0;
  for (std::size_t at = 0; at < file.size();) {
    const Bytes rest = file.from(at);
    if (rest.size() < 12) return {};
    const std::uint32_t type = load_le32(rest.data());
    const std::size_t size = load_le32(rest.data() + 4);
    if (size < 12 || size % 4 != 0 || size > rest.size()) return {};
    if (load_le32(rest.data() + size - 4) != size) return {};
    if (type == 0x0A0D0D0A) {
      if (size != 28 || load_le32(rest.data() + 8) != 0x1A2B3C4D) return {};
      if (load_le16(rest.data() + 12) != 1) return {};
      first = next;
    } else if (type == 1) {
      if (size != 20) return {};  // No options.
      links.push_back(load_le16(rest.data() + 8));
      ++next;
    } else if (type == 6) {
      if (size < 32) return {};
      const std::size_t interface = load_le32(rest.data() + 8);
      if (interface >= next - first || load_le32(rest.data() + 20) > size - 32) return {};
      packets.push_back({at + 28, first + interface, links[first + interface]});
    } else {
      return {};
    }
    if (at == 0 && type != 0x0A0D0D0A) return {};
    at += size;
  }
  return packets;
}

void check_walk(const std::vector<Kept>& packets, Bytes file) {
  const std::vector<Walked> walked = plain_walk(file);
  if (walked.empty()) return;
  require(packets.size() == walked.size(), "a packet for each block of one");
  for (std::size_t i = 0; i < walked.size(); ++i) {
    require(packets[i].packet.interface_id == walked[i].interface,
            "interfaces count on over the sections");
    require(has_head(walked[i].link_type) || packets[i].packet.offset_bytes == walked[i].data_at,
            "a packet begins where its data do");
  }
}

// Applies the changes that the writer documents: times before 1970, or missing beside what a simple
// packet block cannot say, and the header that a sniffer puts before radio frames.
Kept as_written(const Kept& kept, bool first_interface, std::int64_t* last_ns) {
  Kept wanted = kept;
  const Packet packet = kept.get();
  const bool simple = first_interface && packet.comment.empty() &&
                      packet.direction == Direction::kUnknown && packet.dropped_bytes == 0;
  if (packet.time_ns != kNoTime) *last_ns = std::max<std::int64_t>(packet.time_ns, 0);
  wanted.packet.time_ns = packet.time_ns == kNoTime && simple ? kNoTime : *last_ns;
  wanted.packet.link_type = link_type_of(kept.get());
  const bool malformed_zep = kept.packet.link_type == 0;
  require(wanted.packet.link_type == kept.packet.link_type || malformed_zep ||
              kept.packet.link_type == kLinkRadioTap,
          "a packet stays under its link type");
  return wanted;
}

void check_writer(const File& file) {
  PcapngWriter writer;
  std::string written;
  writer.begin(written);
  File wanted;
  std::pair<std::uint16_t, std::string> first;
  std::int64_t last_ns = 0;
  for (std::size_t i = 0; i < file.packets.size(); ++i) {
    const Packet packet = file.packets[i].get();
    const bool held = packet.framing != Framing::kBare || packet.link_type != 0;
    require(writer.write(packet, file.names[i], written) == held,
            "every packet that has a link type can be written");
    if (!held) continue;
    const std::pair<std::uint16_t, std::string> interface { link_type_of(packet), file.names[i] };
    if (wanted.packets.empty()) first = interface;
    wanted.packets.push_back(as_written(file.packets[i], interface == first, &last_ns));
    wanted.names.push_back(file.names[i]);
  }
  writer.finish(written);
  PcapngReader reader;
  std::vector<Kept> packets = testing::read_all(reader, testing::view(written));
  const File again = with_names(reader, std::move(packets));
  fuzz::require_same(again.packets, wanted.packets, "what is written reads back as the same");
  require(again.names == wanted.names, "interfaces keep their names");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes input(data, size);
  const auto make = [] { return std::make_unique<PcapngReader>(); };
  fuzz::require_in_place(fuzz::read_in_any_pieces(make, input), input);
  PcapngReader reader;
  std::vector<Kept> packets = testing::read_all(reader, input);
  for (const Kept& kept : packets) {
    require(kept.packet.link_type == 0 || kept.packet.interface_id < reader.interfaces().size(),
            "a packet was heard on an interface");
  }
  check_walk(packets, input);
  check_writer(with_names(reader, std::move(packets)));
  return 0;
}
