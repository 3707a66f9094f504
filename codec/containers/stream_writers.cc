// Writers of streams and text.
#include "codec/containers/byte_search.h"
#include "codec/containers/crc16_fast.h"
#include "codec/containers/hex_reader.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/sf_reader.h"
#include "codec/containers/writer.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

void append(Bytes bytes, std::string& out) {
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// Escapes the bytes of `out` from `begin` on.
void escape_from(std::size_t begin, std::string& out) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(out.data());
  const std::uint8_t* const end = data + out.size();
  const std::uint8_t* special = find_special_portable(data + begin, end);
  if (special == end) return;
  std::string escaped;
  const std::uint8_t* p = data + begin;
  for (; special != end; special = find_special_portable(p, end)) {
    append(Bytes(p, static_cast<std::size_t>(special - p)), escaped);
    escaped += static_cast<char>(kHdlcEscape);
    escaped += static_cast<char>(*special ^ kHdlcXor);
    p = special + 1;
  }
  append(Bytes(p, static_cast<std::size_t>(end - p)), escaped);
  out.replace(begin, std::string::npos, escaped);
}

}  // namespace

void Writer::begin(std::string&) {}
void Writer::finish(std::string&) {}

bool HdlcWriter::write(const Packet& packet, std::string_view, std::string& out) {
  if (packet.framing != Framing::kHdlc && packet.framing != Framing::kSf) return false;
  //= WIRE-HDLC-TWO-FLAGS: A writer puts two flags between frames, since a mote's receiver drops a
  //= frame that shares its opening flag with the end of the frame before; a reader accepts one.
  out += static_cast<char>(kHdlcFlag);
  const std::size_t begin = out.size();
  if (packet.framing == Framing::kSf) {
    out += static_cast<char>(kSerialPacketNoAck);
    append(packet.bytes, out);
    const Bytes content(reinterpret_cast<const std::uint8_t*>(out.data()) + begin,
                        out.size() - begin);
    const std::uint16_t crc = crc16_fast(content);
    out += static_cast<char>(crc & 0xFF);
    out += static_cast<char>(crc >> 8);
  } else {
    append_serial_content(packet, out);
  }
  escape_from(begin, out);
  if (packet.framing == Framing::kHdlc) {
    // If a frame is cut after an escape that is its first byte, only that escape was ever there.
    const bool nothing = out.size() == begin;
    if (packet.error.fault == Fault::kCut && nothing) out += static_cast<char>(kHdlcEscape);
    if (packet.error.fault == Fault::kCut) return true;
    if (packet.error.fault == Fault::kAborted) out += static_cast<char>(kHdlcEscape);
  }
  out += static_cast<char>(kHdlcFlag);
  return true;
}

void SfWriter::begin(std::string& out) {
  out += static_cast<char>(kSfMagic);
  out += static_cast<char>(kSfVersion);
}

bool SfWriter::write(const Packet& packet, std::string_view, std::string& out) {
  const std::uint64_t size = packet.bytes.size() + packet.dropped_bytes;
  if (size > kSfPacketMax) return false;
  const Fault fault = packet.error.fault;
  if (packet.framing == Framing::kSf) {
    if (fault != Fault::kNone && fault != Fault::kEmpty && fault != Fault::kCut) return false;
  } else if (packet.framing != Framing::kHdlc || fault != Fault::kNone || size == 0) {
    return false;
  }
  out += static_cast<char>(size);
  append(packet.bytes, out);
  return true;
}

bool HexWriter::write(const Packet& packet, std::string_view, std::string& out) {
  if (packet.error.fault != Fault::kNone || packet.bytes.empty()) return false;
  // Such a line would read as the bytes of a serial line.
  const bool packets = packet.framing == Framing::kHdlc || packet.framing == Framing::kSf;
  if (packets && begins_serial_frame(packet.bytes)) return false;
  const char* const digits = upper_case_ ? "0123456789ABCDEF" : "0123456789abcdef";
  for (const std::uint8_t byte : packet.bytes) {
    out += digits[byte >> 4];
    out += digits[byte & 0xF];
    out += ' ';
  }
  out.back() = '\n';
  return true;
}

std::unique_ptr<Writer> make_writer(InputFormat format, std::uint16_t link_type) {
  switch (format) {
    case InputFormat::kHdlc: return std::make_unique<HdlcWriter>();
    case InputFormat::kSf: return std::make_unique<SfWriter>();
    case InputFormat::kPcap: return std::make_unique<PcapWriter>(link_type);
    case InputFormat::kPcapng: return std::make_unique<PcapngWriter>();
    case InputFormat::kHex:
    case InputFormat::kLog: return std::make_unique<HexWriter>();
    case InputFormat::kUnknown:
    case InputFormat::kJsonl: break;
  }
  return nullptr;
}

}  // namespace rubric
