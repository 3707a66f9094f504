#include "codec/containers/hex_reader.h"

#include <algorithm>
#include <array>
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

constexpr std::size_t kStampMost = 48;
constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kBlanks = " \t";

bool is_digit(char c) { return kDigits.find(c) != kDigits.npos; }

std::string_view word_of(std::string_view text) {
  return text.substr(0, text.find_first_of(" \t\r|"));
}

std::size_t after_blanks(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(kBlanks, at), text.size());
}

// Returns whether a word is as 1700000000.123.
bool is_seconds(std::string_view word) {
  const std::size_t point = word.find_first_not_of(kDigits);
  return point != word.npos && point != 0 && point + 1 < word.size() && word[point] == '.' &&
         word.find_first_not_of(kDigits, point + 1) == word.npos;
}

// Returns whether a word is as 12:34:56, and perhaps what follows: a fraction, a zone.
bool is_clock(std::string_view word) {
  const std::size_t hours = std::min(word.find_first_not_of(kDigits), word.size());
  return (hours == 1 || hours == 2) && word.size() >= hours + 3 && word[hours] == ':' &&
         is_digit(word[hours + 1]) && is_digit(word[hours + 2]) && word.back() != ':';
}

// Returns whether a word is as 2026-11-24, 24/11/2026 or 24.11.2026.
bool is_date(std::string_view word) {
  const std::size_t first = word.find_first_not_of(kDigits);
  if (first == word.npos || first == 0 || std::string_view("-/.").find(word[first]) == word.npos) {
    return false;
  }
  const auto is_other = [&](char c) { return c != word[first] && !is_digit(c); };
  return word.find(word[first], first + 1) != word.npos && word.back() != word[first] &&
         std::none_of(word.begin(), word.end(), is_other);
}

// Returns whether a text begins with the whole seconds since 1970, or the milli-, micro- or
// nanoseconds, and hex text. Bytes in words of that size look the same where the size is even: all
// words but the last have one size then.
bool begins_with_epoch(std::string_view text) {
  const std::string_view word = word_of(text);
  const std::size_t size = word.size();
  const bool sized = size == 10 || size == 13 || size == 16 || size == 19;
  if (!sized || word[0] != '1' || word.find_first_not_of(kDigits) != word.npos) return false;
  if (size % 2 != 0) return true;
  const std::string_view rest = text.substr(after_blanks(text, size));
  const std::string_view next = word_of(rest);
  if (next.empty() || next[0] == '#' || text.find(':') != text.npos) return false;
  const std::size_t third = rest.find_first_not_of(" \t\r", next.size());
  const bool last = third == rest.npos || rest[third] == '#';
  return next.size() > size || (next.size() < size && !last);
}

// Returns the end of a text that names who printed a packet, as `mote 2:`; 0 without one.
std::size_t label_end(std::string_view text) {
  if (!text.starts_with("mote") && !text.starts_with("node")) return 0;
  constexpr std::size_t kName = 4;
  const std::size_t number = after_blanks(text, kName);
  const std::size_t end = std::min(text.find_first_not_of(kDigits, number), text.size());
  if (end == number || text.substr(end, 1) != ":") return 0;
  const std::size_t next = after_blanks(text, end + 1);
  const Bytes rest(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  return begins_packet(rest.from(next)) ? next : 0;
}

bool is_month(std::string_view word) {
  constexpr std::array<std::string_view, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  return std::find(kMonths.begin(), kMonths.end(), word) != kMonths.end();
}

// Returns the end of the date that a text begins with, and of the blanks after it; 0 without one.
std::size_t date_end(std::string_view text) {
  std::string_view word = word_of(text);
  std::size_t end = word.size();
  if (is_date(word)) return after_blanks(text, end);
  if (!is_month(word)) return 0;
  const std::size_t day = after_blanks(text, end);
  word = word_of(text.substr(day));
  const bool whole =
      !word.empty() && word.size() <= 2 && word.find_first_not_of(kDigits) == word.npos;
  if (!whole) return 0;
  end = after_blanks(text, day + word.size());
  word = word_of(text.substr(end));
  const bool is_year = word.size() == 4 && word.find_first_not_of(kDigits) == word.npos;
  return is_year ? after_blanks(text, end + word.size()) : end;
}

// Returns the end of a time of day, as 12:34:56 or 10:00:00 AM; 0 without one.
std::size_t clock_end(std::string_view text) {
  const std::size_t end = word_of(text).size();
  if (!is_clock(text.substr(0, end))) return 0;
  const std::size_t half = after_blanks(text, end);
  const std::string_view word = word_of(text.substr(half));
  const bool is_half = word == "AM" || word == "PM" || word == "am" || word == "pm";
  return is_half ? half + word.size() : end;
}

// Returns the end of the stamp itself; 0 without one.
std::size_t stamp_end(std::string_view text) {
  if (text.starts_with('[') || text.starts_with('(')) {
    const std::size_t end = text.find(text[0] == '[' ? ']' : ')');
    const bool dated = text.substr(0, end).find_first_of(kDigits) != text.npos;
    return end != text.npos && dated ? end + 1 : 0;
  }
  std::string_view word = word_of(text);
  if (word.ends_with(':')) word.remove_suffix(1);
  if (is_seconds(word)) return word.size();
  const std::size_t day_end = word.find('T');
  if (day_end != word.npos && is_date(word.substr(0, day_end)) &&
      is_clock(word.substr(day_end + 1))) {
    return word.size();
  }
  const std::size_t date = date_end(text);
  const std::size_t clock = clock_end(text.substr(date));
  return clock == 0 ? 0 : date + clock;
}

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

std::size_t stamp_size(Bytes line) {
  const std::string_view text(reinterpret_cast<const char*>(line.data()), line.size());
  const std::size_t begin = after_blanks(text, 0);
  const std::string_view first = word_of(text.substr(begin));
  if (first.size() == 2 && is_hex_digit(static_cast<std::uint8_t>(first[0]))) return 0;  // A byte.
  std::size_t end = stamp_end(text.substr(begin, kStampMost));
  if (end == 0 && begins_with_epoch(text.substr(begin))) end = word_of(text.substr(begin)).size();
  std::size_t next = begin + end;
  const bool marked = end != 0 && next < text.size() && (text[next] == '|' || text[next] == ':');
  if (marked) ++next;  // The end of the stamp.
  if (end != 0) next = after_blanks(text, next);
  if (end != 0 && text.substr(next, 2) == "->") next = after_blanks(text, next + 2);
  const std::size_t label = label_end(text.substr(next));
  return end == 0 && label == 0 ? 0 : next + label;
}

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
  const Bytes text = line.from(stamp_size(line));
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
  Interface stream;
  stream.name = options.interface_name;
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

void HexReader::serial_bytes(Bytes bytes, PacketSink sink) {
  auto here = [&](const Packet& packet) {
    Packet placed = packet;
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
  const std::size_t stamp = stamp_size(whole);
  const Bytes text = whole.from(stamp);
  Packet packet;
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
    packet.error.offset_bytes += static_cast<std::uint32_t>(stamp);
    packet.bytes = whole;
    packet.dropped_bytes = dropped_;
    return sink(packet);
  }
  if (bytes_.empty()) return;
  const Bytes bytes(bytes_.data(), bytes_.size());
  if (is_serial_bytes(bytes)) return serial_bytes(bytes, sink);
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
  if (in_frame_) serial_bytes(Bytes(), sink);
  line_offset_ = 0;
  line_number_ = 0;
}

}  // namespace rubric
