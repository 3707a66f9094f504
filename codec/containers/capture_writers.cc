// Writers of capture files.
#include <algorithm>

#include "codec/containers/crc16_fast.h"
#include "codec/containers/link_record.h"
#include "codec/containers/pcapng_format.h"
#include "codec/containers/serial_frame.h"
#include "codec/containers/writer.h"

namespace rubric {
namespace {

using namespace pcapng;

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kPcapTimeNsMax = 4'294'967'295'999'999'999;  // Seconds have 32 bits.
constexpr std::uint8_t kResolutionNs = 9;                           // if_tsresol: 10^-9 seconds.

void put16(std::uint64_t value, std::string& out) {
  out += static_cast<char>(value & 0xFF);
  out += static_cast<char>(value >> 8 & 0xFF);
}
void put32(std::uint64_t value, std::string& out) {
  put16(value & 0xFFFF, out);
  put16(value >> 16 & 0xFFFF, out);
}

// Writes a time in the form of pcapng: two halves of 64 bits, the high one first.
void put_time(std::uint64_t ns, std::string& out) {
  put32(ns >> 32, out);
  put32(ns, out);
}

void pad(std::size_t size, std::string& out) { out.append((4 - size % 4) % 4, '\0'); }

void put_option(std::uint16_t code, std::string_view value, std::string& out) {
  put16(code, out);
  put16(value.size(), out);
  out += value;
  pad(value.size(), out);
}

// Opens a block at `begin`, whose length field is filled in later.
std::size_t open_block(std::uint32_t type, std::string& out) {
  const std::size_t begin = out.size();
  put32(type, out);
  put32(0, out);
  return begin;
}
void close_block(std::size_t begin, std::string& out) {
  const std::size_t size = out.size() - begin + kBlockTrailerBytes;
  put32(size, out);
  std::string length;
  put32(size, length);
  out.replace(begin + 4, length.size(), length);
}

bool has_fcs(const Packet& packet) {
  const Fault fault = packet.error.fault;
  return packet.fcs != kAbsent || fault == Fault::kTooShort || fault == Fault::kFcs;
}

// Returns the FCS to write: one that does not fit where that is all that is known of it.
std::uint64_t fcs_of(const Packet& packet) {
  if (packet.fcs != kAbsent) return static_cast<std::uint64_t>(packet.fcs);
  return fcs_fast(packet.bytes) ^ 0xFFFF;
}

// Returns whether a radio frame is written with what its sniffer states. A CC24xx trailer says it
// itself.
bool has_tap_header(const Packet& packet) {
  const bool trailer = packet.link_type == kLinkRadioFcs && packet.fcs != kAbsent;
  return packet.framing == Framing::kRadio && packet.radio.any() && !trailer;
}

std::uint16_t radio_link_type(const Packet& packet) {
  const Fault fault = packet.error.fault;
  if (has_tap_header(packet)) return kLinkRadioTap;
  // A TAP header that was understood is gone, one that was not is all there is.
  const bool header_gone =
      packet.link_type == kLinkRadioTap && packet.error.requirement != "WIRE-RADIO-TAP"_rule;
  // A malformed frame keeps the type under which it was found malformed.
  if (fault != Fault::kNone && packet.link_type != 0 && !header_gone) return packet.link_type;
  return has_fcs(packet) ? kLinkRadioFcs : kLinkRadioNoFcs;
}

std::string_view option_text(std::string_view text) {
  return text.substr(0, std::min<std::size_t>(text.size(), 0xFFFF));
}

}  // namespace

std::uint16_t link_type_of(const Packet& packet) {
  switch (packet.framing) {
    case Framing::kHdlc: return kLinkSerial;
    case Framing::kSf: return kLinkSf;
    case Framing::kRadio: return radio_link_type(packet);
    case Framing::kBare: break;
  }
  return packet.link_type;
}

void append_record(const Packet& packet, std::string& out) {
  if (packet.framing == Framing::kHdlc) return append_serial_content(packet, out);
  if (has_tap_header(packet)) append_tap_header(packet.radio, has_fcs(packet), out);
  out.append(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
  const bool short_of_one = packet.error.fault == Fault::kTooShort && packet.fcs == kAbsent;
  if (packet.framing == Framing::kRadio && has_fcs(packet) && !short_of_one) {
    put16(fcs_of(packet), out);
  }
}

void PcapWriter::begin(std::string& out) {
  put32(0xA1B23C4D, out);
  put16(2, out);
  put16(4, out);
  put32(0, out);
  put32(0, out);
  put32(0x40000, out);  // Snap length.
  put32(link_type_, out);
}

bool PcapWriter::write(const Packet& packet, std::string_view, std::string& out) {
  const std::uint16_t link_type = link_type_of(packet);
  if (link_type == 0 || link_type != link_type_) return false;
  given_times_ += packet.time_ns == kNoTime;
  const auto ns =
      static_cast<std::uint64_t>(std::clamp<std::int64_t>(packet.time_ns, 0, kPcapTimeNsMax));
  put32(ns / kNsPerSecond, out);
  put32(ns % kNsPerSecond, out);
  const std::size_t lengths = out.size();
  put32(0, out);
  put32(0, out);
  append_record(packet, out);
  const std::size_t size = out.size() - lengths - 8;
  std::string fields;
  put32(size, fields);
  put32(size + packet.dropped_bytes, fields);
  out.replace(lengths, fields.size(), fields);
  return true;
}

void PcapngWriter::begin(std::string& out) {
  *this = PcapngWriter();
  const std::size_t block = open_block(kSectionHeader, out);
  put32(kByteOrderMagic, out);
  put16(kMajorVersion, out);
  put16(0, out);
  put32(0xFFFFFFFF, out);  // Section length unknown.
  put32(0xFFFFFFFF, out);
  put_option(kOptShbUserAppl, "rubric", out);
  put_option(kOptEnd, {}, out);
  close_block(block, out);
}

std::uint32_t PcapngWriter::interface_of(std::uint16_t link_type, std::string_view name,
                                         std::string& out) {
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    if (interfaces_[i].link_type != link_type || interfaces_[i].name != name) continue;
    return static_cast<std::uint32_t>(i);
  }
  const std::size_t block = open_block(kInterfaceDescription, out);
  put16(link_type, out);
  put16(0, out);
  put32(0, out);  // No snap length.
  if (!name.empty()) put_option(kOptIfName, option_text(name), out);
  put_option(kOptIfTsresol, std::string(1, static_cast<char>(kResolutionNs)), out);
  put_option(kOptEnd, {}, out);
  close_block(block, out);
  interfaces_.push_back({link_type, std::string(name), 0});
  return static_cast<std::uint32_t>(interfaces_.size() - 1);
}

bool PcapngWriter::write(const Packet& packet, std::string_view interface_name, std::string& out) {
  const std::uint16_t link_type = link_type_of(packet);
  if (link_type == 0) return false;
  const std::uint32_t interface = interface_of(link_type, interface_name, out);
  ++interfaces_[interface].packets;
  record_.clear();
  append_record(packet, record_);
  const bool plain = packet.comment.empty() && packet.direction == Direction::kUnknown;
  if (packet.time_ns == kNoTime && interface == 0 && plain && packet.dropped_bytes == 0) {
    const std::size_t block = open_block(kSimplePacket, out);
    put32(record_.size(), out);
    out += record_;
    pad(record_.size(), out);
    close_block(block, out);
    return true;
  }
  given_times_ += packet.time_ns == kNoTime;
  if (packet.time_ns != kNoTime) last_ns_ = std::max<std::int64_t>(packet.time_ns, 0);
  if (first_ns_ == kNoTime) first_ns_ = last_ns_;
  first_ns_ = std::min(first_ns_, last_ns_);
  latest_ns_ = std::max(latest_ns_, last_ns_);

  const std::size_t block = open_block(kEnhancedPacket, out);
  put32(interface, out);
  put_time(static_cast<std::uint64_t>(last_ns_), out);
  put32(record_.size(), out);
  put32(record_.size() + packet.dropped_bytes, out);
  out += record_;
  pad(record_.size(), out);
  if (!packet.comment.empty()) put_option(kOptComment, option_text(packet.comment), out);
  if (packet.direction != Direction::kUnknown) {
    std::string flags;
    put32(packet.direction == Direction::kInbound ? kDirectionInbound : kDirectionOutbound, flags);
    put_option(kOptPacketFlags, flags, out);
  }
  if (!plain) put_option(kOptEnd, {}, out);
  close_block(block, out);
  return true;
}

void PcapngWriter::finish(std::string& out) {
  if (first_ns_ == kNoTime) return;
  const auto time = [](std::int64_t ns) {
    std::string value;
    put_time(static_cast<std::uint64_t>(ns), value);
    return value;
  };
  for (std::size_t i = 0; i < interfaces_.size(); ++i) {
    const std::size_t block = open_block(kInterfaceStatistics, out);
    put32(i, out);
    put_time(static_cast<std::uint64_t>(latest_ns_), out);
    put_option(kOptIsbStartTime, time(first_ns_), out);
    put_option(kOptIsbEndTime, time(latest_ns_), out);
    std::string packets;
    put32(interfaces_[i].packets, packets);
    put32(interfaces_[i].packets >> 32, packets);
    put_option(kOptIsbIfRecv, packets, out);
    put_option(kOptEnd, {}, out);
    close_block(block, out);
  }
}

}  // namespace rubric
