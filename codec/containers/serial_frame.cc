#include "codec/containers/serial_frame.h"

#include "codec/containers/crc16_fast.h"
#include "codec/runtime/hdlc.h"

namespace rubric {

void split_serial_content(Bytes content, Packet& packet) {
  packet.framing = Framing::kHdlc;
  packet.kind = packet.serial_seq = packet.crc = kAbsent;
  packet.bytes = content;
  if (content.empty()) return;
  packet.kind = content[0];
  std::size_t begin = 1;
  std::size_t end = content.size();
  if (packet.dropped_bytes == 0 && end - begin >= kSerialCrcBytes) {
    end -= kSerialCrcBytes;
    packet.crc = load_le16(content.data() + end);
  }
  if (serial_kind_has_seq(packet.kind) && begin != end) packet.serial_seq = content[begin++];
  packet.bytes = content.sub(begin, end - begin);
}

void append_serial_content(const Packet& packet, std::string& out) {
  if (packet.kind != kAbsent) out += static_cast<char>(packet.kind);
  if (packet.serial_seq != kAbsent) out += static_cast<char>(packet.serial_seq);
  out.append(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
  if (packet.crc != kAbsent) {
    out += static_cast<char>(packet.crc & 0xFF);
    out += static_cast<char>(packet.crc >> 8);
  }
}

Error check_serial_content(Bytes content, CpuPath path) {
  const std::size_t size = content.size();
  const std::size_t max = serial_content_max(content.empty() ? 0 : content[0]);
  if (size > max) return fail(Fault::kTooLong, max, "WIRE-HDLC-LONG"_rule).error;
  if (size < kSerialContentMin) return fail(Fault::kTooShort, size, "WIRE-HDLC-SHORT"_rule).error;
  const std::size_t crc_at = size - kSerialCrcBytes;
  if (crc16_fast(content.first(crc_at), 0, path) != load_le16(content.data() + crc_at)) {
    return fail(Fault::kCrc, crc_at, "WIRE-SERIAL-CRC"_rule).error;
  }
  return Error{Fault::kNone, 0, ReqId::kNone};
}

void decode_serial_content(Bytes content, Packet& packet) {
  split_serial_content(content, packet);
  packet.error = check_serial_content(content);
}

}  // namespace rubric
