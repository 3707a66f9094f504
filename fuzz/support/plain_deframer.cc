#include "fuzz/support/plain_deframer.h"

#include <algorithm>

namespace rubric::fuzz {
namespace {

constexpr std::size_t kKept = 4096;

enum class End { kFlag, kAborted, kInput };

std::uint16_t plain_crc(const std::string& bytes) {
  unsigned crc = 0;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned>(static_cast<std::uint8_t>(c)) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1;
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

Error error_at(Fault fault, std::size_t at, ReqId rule) {
  return Error{fault, static_cast<std::uint32_t>(at), rule};
}

Error judge(const std::string& content, const std::string& kept, End end) {
  if (end == End::kInput) return error_at(Fault::kCut, kept.size(), "WIRE-HDLC-FLAG"_rule);
  if (end == End::kAborted) return error_at(Fault::kAborted, kept.size(), "WIRE-HDLC-ESCAPE"_rule);
  const std::uint8_t kind = static_cast<std::uint8_t>(content[0]);
  const std::size_t most = kind == 0x43 || kind == 0x44 ? 256 : 255;
  if (content.size() > most) return error_at(Fault::kTooLong, most, "WIRE-HDLC-LONG"_rule);
  if (content.size() < 4) return error_at(Fault::kTooShort, content.size(), "WIRE-HDLC-SHORT"_rule);
  const std::size_t crc_at = content.size() - 2;
  const std::uint16_t crc = plain_crc(content.substr(0, crc_at));
  const bool matches = content[crc_at] == static_cast<char>(crc & 0xFF) &&
                       content[crc_at + 1] == static_cast<char>(crc >> 8);
  if (!matches) return error_at(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule);
  return error_at(Fault::kNone, 0, ReqId::kNone);
}

testing::Kept packet_of(const std::string& content, std::uint64_t offset, End end) {
  const std::string kept = content.substr(0, kKept);
  Packet packet;
  packet.framing = Framing::kHdlc;
  packet.offset_bytes = offset;
  packet.error = judge(content, kept, end);
  packet.dropped_bytes = content.size() - kept.size();
  std::string middle = kept;
  if (!middle.empty()) {
    packet.kind = static_cast<std::uint8_t>(middle[0]);
    middle.erase(0, 1);
  }
  if (packet.dropped_bytes == 0 && middle.size() >= 2) {
    const auto low = static_cast<std::uint8_t>(middle[middle.size() - 2]);
    const auto high = static_cast<std::uint8_t>(middle[middle.size() - 1]);
    packet.crc = high * 256 + low;
    middle.resize(middle.size() - 2);
  }
  if ((packet.kind == 0x43 || packet.kind == 0x44) && !middle.empty()) {
    packet.serial_seq = static_cast<std::uint8_t>(middle[0]);
    middle.erase(0, 1);
  }
  packet.bytes = testing::view(middle);
  return testing::Kept(packet);
}

}  // namespace

std::vector<testing::Kept> plain_deframe(Bytes stream) {
  std::vector<testing::Kept> packets;
  std::string content;
  std::uint64_t begin = 0;
  bool open = false;
  bool escaped = false;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const std::uint8_t byte = stream[i];
    if (byte == 0x7E) {
      if (open) packets.push_back(packet_of(content, begin, escaped ? End::kAborted : End::kFlag));
      open = escaped = false;
      content.clear();
      continue;
    }
    if (!open) begin = i;
    open = true;
    if (byte == 0x7D && !escaped) {
      escaped = true;
      continue;
    }
    content += static_cast<char>(escaped ? byte ^ 0x20 : byte);
    escaped = false;
  }
  if (open) packets.push_back(packet_of(content, begin, End::kInput));
  return packets;
}

}  // namespace rubric::fuzz
