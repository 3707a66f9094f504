#include "codec/containers/radio_line.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include "codec/containers/hex_reader.h"
#include "codec/containers/link_record.h"

namespace rubric {
namespace {

constexpr std::size_t kOverwrittenBytes = 2;

/// The rest of a line, taken from its front.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  std::string_view rest() const { return rest_; }

  /// Takes the next word, which ends before a blank or a tab; empty at the end.
  std::string_view word() {
    const std::size_t begin = std::min(rest_.find_first_not_of(" \t\r"), rest_.size());
    const std::size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view out = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return out;
  }

  bool number(std::int64_t& value) { return number_in(word(), value); }

  static bool number_in(std::string_view text, std::int64_t& value) {
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    return fault == std::errc() && end == text.data() + text.size();
  }

 private:
  std::string_view rest_;
};

bool decode_hex(std::string_view text, std::vector<std::uint8_t>& bytes) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(text.data());
  return decode_hex_line(Bytes(data, text.size()), bytes).fault == Fault::kNone && !bytes.empty();
}

// Reads what follows "received:" or "psdu:".
bool read_sniffer_line(Words words, RadioLine& line, std::vector<std::uint8_t>& bytes) {
  constexpr std::int64_t kNsPerUs = 1000;
  constexpr std::int64_t kUsMost = INT64_MAX / kNsPerUs;
  const std::string_view hex = words.word();
  std::int64_t power = 0;
  std::int64_t lqi = 0;
  std::int64_t time_us = 0;
  const bool whole = words.word() == "power:" && words.number(power) && words.word() == "lqi:" &&
                     words.number(lqi) && words.word() == "time:" && words.number(time_us);
  if (!whole || lqi < 0 || lqi > 255 || time_us < 0 || time_us > kUsMost) return false;
  if (!decode_hex(hex, bytes)) return false;
  constexpr std::int64_t kPowerUnknown = INT16_MIN;
  if (power != kPowerUnknown) line.radio.rssi = static_cast<float>(power);
  line.radio.lqi = static_cast<std::int16_t>(lqi);
  line.time_ns = time_us * kNsPerUs;
  line.link_type = kLinkRadioNoFcs;
  return true;
}

// Reads a line of Cooja, whose first word is a time.
bool read_cooja_line(std::int64_t time_ms, Words words, RadioLine& line,
                     std::vector<std::uint8_t>& bytes) {
  constexpr std::int64_t kNsPerMs = 1'000'000;
  std::int64_t node = 0;
  std::int64_t size = 0;
  if (time_ms < 0 || time_ms > INT64_MAX / kNsPerMs || !words.number(node)) return false;
  if (words.word().empty()) return false;  // Nodes that heard it.
  std::string_view count = words.word();
  if (!count.ends_with(':')) return false;
  count.remove_suffix(1);
  const bool sized = Words::number_in(count, size) && decode_hex(words.rest(), bytes) &&
                     bytes.size() == static_cast<std::size_t>(size);
  if (!sized) return false;
  line.time_ns = time_ms * kNsPerMs;
  line.link_type = kLinkRadioLinux;
  return true;
}

}  // namespace

bool read_radio_line(Bytes text, RadioLine& line, std::vector<std::uint8_t>& bytes) {
  line = RadioLine();
  Words words({reinterpret_cast<const char*>(text.data()), text.size()});
  const std::string_view first = words.word();
  std::int64_t time_ms = 0;
  if (first == "psdu:") return read_sniffer_line(words, line, bytes);
  if (first != "received:") {
    return Words::number_in(first, time_ms) && read_cooja_line(time_ms, words, line, bytes);
  }
  const bool whole = read_sniffer_line(words, line, bytes) && bytes.size() > kOverwrittenBytes;
  if (whole) bytes.resize(bytes.size() - kOverwrittenBytes);
  return whole;
}

}  // namespace rubric
