// Entry point for radio_fuzz, whose input is two bytes and one record of a capture file.
#include "codec/containers/link_record.h"
#include "fuzz/mutators/entry.h"
#include "fuzz/support/mutate_bytes.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  using namespace rubric;
  constexpr std::size_t kHead = 2;
  fuzz::PacketMutator& mutator = fuzz::seeded_mutator(seed);
  // Half of the time mutates plain bytes: a TAP header and odd frame controls are no messages.
  if (max_size <= kHead || mutator.random().below(2) == 0) {
    return fuzz::mutate_bytes(data, size, max_size, seed);
  }
  fuzz::PacketStream stream{.format = InputFormat::kPcap};
  const bool has_fcs = mutator.random().below(2) == 0;
  stream.link_type = has_fcs ? kLinkRadioFcs : kLinkRadioNoFcs;
  if (size > kHead && data[0] % 3 != 2) {
    Packet packet;
    fuzz::StreamPacket kept;
    const Bytes record(data + kHead, size - kHead);
    decode_record(record, record.size(), stream.link_type, "WIRE-PCAP"_rule, packet);
    kept.bytes.assign(packet.bytes.begin(), packet.bytes.end());
    kept.packet = packet;
    kept.packet.bytes = Bytes();
    stream.packets.push_back(kept);
  }
  mutator.change(stream);
  if (stream.packets.empty()) return fuzz::mutate_bytes(data, size, max_size, seed);
  std::string record;
  append_record(stream.packets.back().view(), record);
  data[0] = has_fcs ? 0 : 1;
  data[1] = 0;
  return fuzz::copy_out({record.begin(), record.end()}, kHead, data, max_size);
}
