// Property: any split of a pcapng file gives the same packets and interfaces, all lying in the file
// where they say; and what is written from them reads back as the same.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "codec/containers/link_record.h"
#include "codec/containers/pcapng_reader.h"
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

// What the writer promises to change: times that are missing or before 1970, and the header that a
// sniffer puts before radio frames.
Kept as_written(const Kept& kept, std::int64_t* last_ns) {
  Kept wanted = kept;
  if (kept.packet.time_ns != kNoTime) *last_ns = std::max<std::int64_t>(kept.packet.time_ns, 0);
  wanted.packet.time_ns = *last_ns;
  wanted.packet.link_type = link_type_of(kept.get());
  require(wanted.packet.link_type == kept.packet.link_type ||
              kept.packet.link_type == kLinkRadioTap,
          "a packet stays under its link type");
  return wanted;
}

void check_writer(const File& file) {
  PcapngWriter writer;
  std::string written;
  writer.begin(written);
  File wanted;
  std::int64_t last_ns = 0;
  for (std::size_t i = 0; i < file.packets.size(); ++i) {
    const Packet packet = file.packets[i].get();
    const bool held = packet.framing != Framing::kBare || packet.link_type != 0;
    require(writer.write(packet, file.names[i], written) == held,
            "every packet that has a link type can be written");
    if (!held) continue;
    wanted.packets.push_back(as_written(file.packets[i], &last_ns));
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
  check_writer(with_names(reader, std::move(packets)));
  return 0;
}
