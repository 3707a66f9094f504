// Property: any split of a serial forwarder's stream gives the packets that a plain loop over its
// length bytes finds, and their output reads back as the same, even by way of a serial line.
#include <cstddef>
#include <cstdint>

#include "codec/containers/reader.h"
#include "codec/containers/sf_reader.h"
#include "codec/containers/writer.h"
#include "codec/runtime/hdlc.h"
#include "fuzz/support/readers.h"
#include "fuzz/support/require.h"

namespace {

using namespace rubric;
using fuzz::Kept;
using fuzz::require;

void add(std::vector<Kept>& packets, std::size_t offset, Bytes bytes, std::size_t missing,
         Error error) {
  Packet packet;
  packet.framing = Framing::kSf;
  packet.offset_bytes = offset;
  packet.bytes = bytes;
  packet.dropped_bytes = missing;
  packet.error = error;
  packets.emplace_back(packet);
}

Error error_at(Fault fault, std::size_t at, ReqId rule) {
  return Error{fault, static_cast<std::uint32_t>(at), rule};
}

std::vector<Kept> plain_packets(Bytes stream) {
  std::vector<Kept> packets;
  if (stream.size() == 1 && stream[0] == 'U') {
    add(packets, 0, Bytes(), 1, error_at(Fault::kCut, 1, "WIRE-SF-HANDSHAKE"_rule));
    return packets;
  }
  std::size_t at = 0;
  if (!stream.empty()) {
    const std::size_t wrong = stream[0] == 'U' ? 1 : 0;
    if (wrong == 1 && stream[1] >= 0x20) {
      at = 2;
    } else {
      add(packets, 0, stream.first(wrong + 1), 0,
          error_at(Fault::kHandshake, wrong, "WIRE-SF-HANDSHAKE"_rule));
    }
  }
  while (at < stream.size()) {
    const std::size_t size = stream[at];
    const Bytes rest = stream.from(at + 1);
    if (size == 0) {
      add(packets, at, Bytes(), 0, error_at(Fault::kEmpty, 0, "WIRE-SF-LENGTH"_rule));
    } else if (rest.size() < size) {
      add(packets, at, rest, size - rest.size(),
          error_at(Fault::kCut, 1 + rest.size(), "WIRE-SF-LENGTH"_rule));
      break;
    } else {
      add(packets, at, rest.first(size), 0, error_at(Fault::kNone, 0, ReqId::kNone));
    }
    at += 1 + size;
  }
  return packets;
}

void check_writer(const std::vector<Kept>& packets) {
  SfWriter writer;
  std::string written;
  writer.begin(written);
  std::vector<Kept> wanted;
  for (const Kept& kept : packets) {
    // A broken handshake is not part of what follows it.
    if (kept.packet.error.requirement == "WIRE-SF-HANDSHAKE"_rule) continue;
    require(writer.write(kept.get(), written), "every packet of a forwarder can be written");
    wanted.push_back(fuzz::placeless(kept));
  }
  SfReader reader;
  std::vector<Kept> again = testing::read_all(reader, testing::view(written));
  for (Kept& kept : again) kept = fuzz::placeless(kept);
  fuzz::require_same(again, wanted, "what is written reads back as the same");
}

// Converts as `rubric convert` does.
void check_by_serial_line(const std::vector<Kept>& packets) {
  const auto to_line = make_writer(InputFormat::kHdlc, 0);
  const auto to_forwarder = make_writer(InputFormat::kSf, 0);
  for (const Kept& kept : packets) {
    const bool fits = kept.bytes.size() <= kSerialAfterHeaderMax - kSerialCrcBytes;
    if (kept.packet.error.fault != Fault::kNone || !fits) continue;
    std::string line;
    require(to_line->write(kept.get(), "", line), "a serial line takes a forwarder's packet");
    const auto reader = make_reader(InputFormat::kHdlc, {});
    const std::vector<Kept> frames = testing::read_all(*reader, testing::view(line));
    require(frames.size() == 1 && frames[0].bytes == kept.bytes, "and carries it");
    std::string back;
    require(to_forwarder->write(frames[0].get(), "", back), "a forwarder takes it from there");
    require(back == static_cast<char>(kept.bytes.size()) + kept.bytes, "as it was");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes stream(data, size);
  const std::vector<Kept> wanted = plain_packets(stream);
  const auto make = [] { return std::make_unique<SfReader>(); };
  fuzz::require_same(fuzz::read_in_any_pieces(make, stream), wanted,
                     "the reader finds what a plain loop finds");
  check_writer(wanted);
  check_by_serial_line(wanted);
  return 0;
}
