// Property: no input, however it is framed or split, makes a reader or the decoder read outside it,
// and what decodes lies within the packet.
#include <cstddef>
#include <cstdint>

#include "codec/containers/reader.h"
#include "codec/reflect/frame.h"
#include "codec/reflect/registry.h"
#include "fuzz/support/require.h"

namespace {

using rubric::fuzz::require;

void check_nodes(const rubric::reflect::Decoded& decoded) {
  for (std::size_t i = 0; i < decoded.node_count(); ++i) {
    const rubric::reflect::Node& node = decoded[i];
    require(node.offset + node.size <= decoded.bytes.size(), "a field lies within the packet");
    require(node.end > i && node.end <= decoded.node_count(), "nodes are nested");
  }
  for (std::size_t i = 0; i < decoded.stale_count(); ++i) {
    require(decoded.stale()[i].offset + decoded.stale()[i].size <= decoded.bytes.size(),
            "stale bytes lie within the packet");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rubric;
  if (size < 2) return 0;
  constexpr InputFormat kFormats[] = {InputFormat::kHdlc, InputFormat::kSf, InputFormat::kPcap,
                                      InputFormat::kPcapng, InputFormat::kHex};
  // The first byte chooses the format, the second where the input is split.
  const auto reader = make_reader(kFormats[data[0] % std::size(kFormats)]);
  const Bytes input = Bytes(data + 2, size - 2);
  const std::size_t split = input.size() * data[1] / 255;

  static const reflect::FrameDecoder decoder(*reflect::find_protocol("rubicon"));
  static reflect::Frame frame;
  auto take = [](const Packet& packet) {
    decoder.decode(packet, frame);
    check_nodes(frame.decoded);
  };
  reader->feed(input.first(split), take);
  reader->feed(input.from(split), take);
  reader->finish(take);
  return 0;
}
