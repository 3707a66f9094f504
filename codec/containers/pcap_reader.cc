#include "codec/containers/pcap_reader.h"

#include <algorithm>

#include "codec/containers/capture_time.h"
#include "codec/containers/link_record.h"

namespace rubric {
namespace {

constexpr std::size_t kFileHeaderBytes = 24;
constexpr std::size_t kRecordHeaderBytes = 16;
constexpr std::uint32_t kMagicMicro = 0xA1B2C3D4;
constexpr std::uint32_t kMagicNano = 0xA1B23C4D;

}  // namespace

UnitReader::Step PcapReader::step(Bytes input, PacketSink sink) {
  if (damaged_) {
    damage_.dropped_bytes += input.size();
    return used(input.size());
  }
  if (!has_header_) return file_header(input);
  if (input.size() < kRecordHeaderBytes) return want(kRecordHeaderBytes);
  const std::uint8_t* const header = input.data();
  const std::size_t captured = load32(header + 8);
  if (captured > kCaptureRecordMax) return damage(input.first(kRecordHeaderBytes), 8);
  if (input.size() < kRecordHeaderBytes + captured) return want(kRecordHeaderBytes + captured);
  const Interface& interface = interfaces_[0];
  Packet packet{.offset_bytes = offset() + kRecordHeaderBytes};
  packet.time_ns =
      time_ns_of_ticks(load32(header) * interface.ticks_per_second + load32(header + 4), interface);
  decode_record(input.sub(kRecordHeaderBytes, captured), load32(header + 12), interface.link_type,
                "WIRE-PCAP"_rule, packet);
  sink(packet);
  return used(kRecordHeaderBytes + captured);
}

UnitReader::Step PcapReader::file_header(Bytes input) {
  if (input.size() < kFileHeaderBytes) return want(kFileHeaderBytes);
  Interface interface;
  const std::uint32_t magic_le = load_le32(input.data());
  const std::uint32_t magic_be = load_be32(input.data());
  big_endian_ = magic_be == kMagicMicro || magic_be == kMagicNano;
  const std::uint32_t magic = big_endian_ ? magic_be : magic_le;
  if (magic != kMagicMicro && magic != kMagicNano) return damage(input.first(kFileHeaderBytes), 0);
  interface.ticks_per_second = magic == kMagicNano ? 1'000'000'000 : 1'000'000;
  // The upper half of the field is the length of an Ethernet FCS, which is ignored.
  interface.link_type =
      link_read_as(static_cast<std::uint16_t>(load32(input.data() + 20)), options_);
  interfaces_.assign(1, interface);
  has_header_ = true;
  return used(kFileHeaderBytes);
}

UnitReader::Step PcapReader::damage(Bytes header, std::uint32_t offset_bytes) {
  damaged_ = true;
  damage_ = Packet();
  damage_.offset_bytes = offset();
  damage_.error = Error{Fault::kContainer, offset_bytes, "WIRE-PCAP"_rule};
  std::copy(header.begin(), header.end(), damaged_header_);
  damage_.bytes = Bytes(damaged_header_, header.size());
  return used(header.size());
}

void PcapReader::end(Bytes rest, PacketSink sink) {
  if (damaged_) {
    sink(damage_);
  } else if (!rest.empty() || !has_header_) {
    Packet packet;
    packet.offset_bytes = offset();
    packet.bytes = rest;
    packet.error = fail(Fault::kCut, rest.size(), "WIRE-PCAP"_rule).error;
    sink(packet);
  }
  has_header_ = false;
  damaged_ = false;
}

}  // namespace rubric
