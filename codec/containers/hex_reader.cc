#include "codec/containers/hex_reader.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "codec/containers/link_record.h"
#include "codec/containers/radio_line.h"
#include "codec/runtime/hdlc.h"

namespace rubric {
namespace {

constexpr int kNoDigit = -1;

int hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = c | 0x20;
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : kNoDigit;
}

bool is_space(std::uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::uint16_t link_type_of(const ReaderOptions& options) {
  switch (options.hex_framing) {
    case Framing::kHdlc: return kLinkSerial;
    case Framing::kSf: return kLinkSf;
    case Framing::kRadio: return options.hex_has_fcs ? kLinkRadioFcs : kLinkRadioNoFcs;
    case Framing::kBare: break;
  }
  return 0;
}

}  // namespace

bool begins_packet(Bytes text) {
  std::size_t pairs = 0;
  for (std::size_t at = 0; pairs != kPacketLineBytes; at += 2, ++pairs) {
    while (at < text.size() && is_space(text[at])) ++at;
    if (at + 1 >= text.size() || !is_hex_digit(text[at]) || !is_hex_digit(text[at + 1])) {
      return false;
    }
  }
  return true;
}

std::size_t unknown_prefix(Bytes line) {
  const Bytes text = line.from(read_stamp(line).size);
  const auto* at = std::find_if_not(text.begin(), text.end(), is_space);
  if (begins_packet(text)) return 0;
  while (at != line.end()) {
    if (begins_packet(line.from(static_cast<std::size_t>(at - line.begin())))) {
      return static_cast<std::size_t>(at - line.begin());
    }
    at = std::find_if_not(std::find_if(at, line.end(), is_space), line.end(), is_space);
  }
  return 0;
}

std::size_t mark_size(Bytes text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  const std::string_view begin(reinterpret_cast<const char*>(text.data()), text.size());
  return begin.starts_with(kMark) ? kMark.size() : 0;
}

bool is_hex_digit(std::uint8_t c) { return hex_digit(c) != kNoDigit; }

bool begins_serial_frame(Bytes bytes) {
  if (bytes[0] != kHdlcFlag) return false;
  return bytes.size() == 1 || bytes[1] == kHdlcFlag || bytes[1] == kSerialUnknown ||
         (bytes[1] >= kSerialAck && bytes[1] <= kSerialPacketNoAck);
}

Error decode_hex_line(Bytes text, std::vector<std::uint8_t>& bytes) {
  bytes.clear();
  bool at_token = true;  // Where a 0x may begin.
  for (std::size_t i = 0; i < text.size();) {
    if (is_space(text[i])) {
      at_token = true;
      ++i;
      continue;
    }
    if (text[i] == '#') break;
    const bool pair = i + 1 < text.size();
    if (at_token && pair && text[i] == '0' && (text[i + 1] | 0x20) == 'x') {
      i += 2;
      at_token = false;
      // A 0x with nothing after it is no byte.
      if (i < text.size() && hex_digit(text[i]) != kNoDigit) continue;
      return fail(Fault::kUnexpected, i, "WIRE-HEX"_rule).error;
    }
    at_token = false;
    const int high = hex_digit(text[i]);
    if (high == kNoDigit) return fail(Fault::kUnexpected, i, "WIRE-HEX"_rule).error;
    const int low = pair ? hex_digit(text[i + 1]) : kNoDigit;
    if (low == kNoDigit) return fail(Fault::kUnexpected, i + 1, "WIRE-HEX"_rule).error;
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
    i += 2;
  }
  return Error{Fault::kNone, 0, ReqId::kNone};
}

bool is_noise(Bytes line) {
  const auto is_other = [](std::uint8_t c) { return !is_hex_digit(c); };
  bool first = true;
  for (const std::uint8_t* at = line.begin();;) {
    const auto* begin = std::find_if_not(at, line.end(), is_space);
    const auto* const end = std::find_if(begin, line.end(), is_space);
    if (begin == end || (!first && *begin == '#')) return first;
    if (first && is_other(*begin)) return true;
    if (end - begin > 2 && *begin == '0' && (begin[1] | 0x20) == 'x') begin += 2;
    const auto others = std::count_if(begin, end, is_other);
    if (others > 1 || (first && end - begin > 2 && others != 0)) return true;
    first = false;
    at = end;
  }
}

HexReader::HexReader(const ReaderOptions& options, bool is_log)
    : options_(options), is_log_(is_log) {
  Interface stream{.name = options.interface_name};
  interfaces_.push_back(stream);
}

void HexReader::feed(Bytes chunk, PacketSink sink) {
  while (!chunk.empty()) {
    const void* const found = std::memchr(chunk.data(), '\n', chunk.size());
    if (found == nullptr) return hold(chunk);
    const auto size =
        static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - chunk.data());
    if (held_.empty() && size <= kHexLineMax) {
      line(chunk.first(size), sink);
      line_offset_ += size;
    } else {
      hold(chunk.first(size));
      deliver_held(sink);
    }
    ++line_offset_;
    chunk = chunk.from(size + 1);
  }
}

void HexReader::hold(Bytes text) {
  const std::size_t kept = std::min(text.size(), kHexLineMax - held_.size());
  held_.insert(held_.end(), text.begin(), text.begin() + kept);
  dropped_ += text.size() - kept;
}

void HexReader::deliver_held(PacketSink sink) {
  line(Bytes(held_.data(), held_.size()), sink);
  line_offset_ += held_.size() + dropped_;
  held_.clear();
  dropped_ = 0;
}

bool HexReader::is_serial_bytes(Bytes bytes) const {
  if (options_.hex_framing != Framing::kSf) return false;
  return in_frame_ || begins_serial_frame(bytes);
}

void HexReader::serial_bytes(Bytes bytes, std::int64_t time_ns, PacketSink sink) {
  auto here = [&](const Packet& packet) {
    Packet placed = packet;
    placed.time_ns = time_ns;
    placed.offset_bytes = line_offset_;
    placed.line = line_number_;
    sink(placed);
  };
  if (!serial_) serial_ = std::make_unique<HdlcReader>(options_);
  if (bytes.empty()) {
    serial_->finish(here);
    in_frame_ = false;
    return;
  }
  serial_->feed(bytes, here);
  in_frame_ = bytes[bytes.size() - 1] != kHdlcFlag;
}

std::int64_t HexReader::time_of(const LineStamp& stamp) {
  constexpr std::int64_t kHalfADayNs = kDayNs / 2;
  if (!stamp.of_day) return stamp.time_ns;
  if (of_day_ns_ - stamp.time_ns > kHalfADayNs) ++days_;
  of_day_ns_ = stamp.time_ns;
  return days_ * kDayNs + stamp.time_ns;
}

void HexReader::pass_over(Bytes whole) {
  if (noise_.lines++ == 0) noise_.first = line_number_;
  if (noise_.prefixed != 0) return;
  const std::size_t prefix = unknown_prefix(whole);
  if (prefix == 0) return;
  noise_.prefixed = line_number_;
  noise_.prefix.assign(whole.begin(), whole.begin() + prefix);
}

void HexReader::line(Bytes whole, PacketSink sink) {
  ++line_number_;
  if (line_number_ == 1) whole = whole.from(mark_size(whole));
  const LineStamp stamp = read_stamp(whole);
  const Bytes text = whole.from(stamp.size);
  if (noise_.marker.empty()) noise_.marker = stamp.marker;
  Packet packet;
  packet.time_ns = time_of(stamp);
  packet.line = line_number_;
  packet.framing = options_.hex_framing;
  packet.direction = options_.direction;
  packet.offset_bytes = line_offset_;
  const bool frames = is_log_ && options_.hex_framing != Framing::kBare && dropped_ == 0;
  if (RadioLine stated; frames && read_radio_line(text, stated, bytes_)) {
    const Bytes bytes(bytes_.data(), bytes_.size());
    decode_record(bytes, bytes.size(), stated.link_type, "WIRE-HEX"_rule, packet);
    packet.time_ns = stated.time_ns;
    packet.radio = stated.radio;
    return sink(packet);
  }
  packet.error = decode_hex_line(text, bytes_);
  if (dropped_ != 0) packet.error = fail(Fault::kTooLong, text.size(), "WIRE-HEX"_rule).error;
  const bool noise = is_log_ && packet.error.fault == Fault::kUnexpected && is_noise(text);
  if (noise) return pass_over(whole);
  if (packet.error.fault != Fault::kNone) {
    packet.framing = Framing::kBare;
    packet.error.offset_bytes += static_cast<std::uint32_t>(stamp.size);
    packet.bytes = whole;
    packet.dropped_bytes = dropped_;
    return sink(packet);
  }
  if (bytes_.empty()) return;
  const Bytes bytes(bytes_.data(), bytes_.size());
  if (is_serial_bytes(bytes)) return serial_bytes(bytes, packet.time_ns, sink);
  if (is_log_ && options_.hex_framing == Framing::kSf && bytes.size() < kPacketLineBytes) {
    return pass_over(whole);
  }
  if (options_.hex_framing == Framing::kBare) {
    packet.bytes = bytes;
  } else {
    decode_record(bytes, bytes.size(), link_type_of(options_), "WIRE-HEX"_rule, packet);
    if (packet.framing != Framing::kRadio) packet.link_type = 0;
  }
  sink(packet);
}

void HexReader::finish(PacketSink sink) {
  if (!held_.empty()) deliver_held(sink);
  if (in_frame_) serial_bytes(Bytes(), kNoTime, sink);
  line_offset_ = 0;
  line_number_ = 0;
  of_day_ns_ = days_ = 0;
}

}  // namespace rubric
