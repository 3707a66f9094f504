// Reads what is before the bytes in a line of hex text.
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>

#include "codec/containers/hex_reader.h"

namespace rubric {
namespace {

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

std::size_t bracket_end(std::string_view text) { return text.find(text[0] == '[' ? ']' : ')'); }

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

// Returns the number of a month, from 1; 0 for another word.
int month_of(std::string_view word) {
  constexpr std::array<std::string_view, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                     "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto* const found = std::find(kMonths.begin(), kMonths.end(), word);
  return found == kMonths.end() ? 0 : static_cast<int>(found - kMonths.begin()) + 1;
}

// Returns the end of the date that a text begins with, and of the blanks after it; 0 without one.
std::size_t date_end(std::string_view text) {
  std::string_view word = word_of(text);
  std::size_t end = word.size();
  if (is_date(word)) return after_blanks(text, end);
  if (month_of(word) == 0) return 0;
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
    const std::size_t end = bracket_end(text);
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

constexpr std::int64_t kStampSecondNs = 1'000'000'000;
constexpr std::size_t kDecimalsMin = 3;
constexpr std::size_t kDecimalsMost = 9;

// Takes the parts of a time from the front of a text.
class TimeText {
 public:
  explicit TimeText(std::string_view text) : rest_(text) {}

  bool take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  /// Takes `least` to `most` digits, and no other follows.
  bool number(std::size_t least, std::size_t most, std::int64_t& value) {
    const std::size_t size = std::min(rest_.find_first_not_of(kDigits), rest_.size());
    if (size < least || size > most) return false;
    std::from_chars(rest_.data(), rest_.data() + size, value);
    rest_.remove_prefix(size);
    return true;
  }

  /// Takes the decimals of a second, milliseconds at least.
  bool decimals(std::int64_t& ns) {
    const std::size_t size = std::min(rest_.find_first_not_of(kDigits), rest_.size());
    if (size < kDecimalsMin) return false;
    ns = 0;
    for (std::size_t i = 0; i < kDecimalsMost; ++i) ns = ns * 10 + (i < size ? rest_[i] - '0' : 0);
    rest_.remove_prefix(size);
    return true;
  }

  std::string_view rest() const { return rest_; }
  void skip_blanks() { rest_.remove_prefix(after_blanks(rest_, 0)); }

 private:
  std::string_view rest_;
};

// Takes a date that leaves nothing open: 2026-11-24, 2026/11/24, 24.11.2026 or Nov 24 2026.
bool take_date(TimeText& text, std::int64_t& days) {
  std::int64_t year = 0;
  std::int64_t month = 0;
  std::int64_t day = 0;
  const TimeText begin = text;
  const auto year_first = [&](char sign) {
    text = begin;
    return text.number(4, 4, year) && text.take(sign) && text.number(1, 2, month) &&
           text.take(sign) && text.number(1, 2, day);
  };
  const auto day_first = [&] {
    text = begin;
    return text.number(1, 2, day) && text.take('.') && text.number(1, 2, month) && text.take('.') &&
           text.number(4, 4, year);
  };
  const auto named = [&] {
    text = begin;
    month = month_of(word_of(text.rest()));
    for (int i = 0; i < 3 && month != 0; ++i) text.take(text.rest()[0]);
    text.skip_blanks();
    const bool has_day = month != 0 && text.number(1, 2, day);
    text.skip_blanks();
    return has_day && text.number(4, 4, year);
  };
  if (!year_first('-') && !year_first('/') && !day_first() && !named()) return false;
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  days = std::chrono::sys_days(date).time_since_epoch().count();
  return date.ok();
}

// Takes a time of day with decimals, as 13:55:05.123 or 1:55:05,123 PM.
bool take_clock(TimeText& text, std::int64_t& ns) {
  std::int64_t hours = 0;
  std::int64_t minutes = 0;
  std::int64_t seconds = 0;
  const bool whole = text.number(1, 2, hours) && text.take(':') && text.number(2, 2, minutes) &&
                     text.take(':') && text.number(2, 2, seconds) &&
                     (text.take('.') || text.take(',')) && text.decimals(ns);
  if (!whole || hours > 23 || minutes > 59 || seconds > 60) return false;
  TimeText after = text;
  after.skip_blanks();
  const char half = after.rest().empty() ? '\0' : static_cast<char>(after.rest()[0] | 0x20);
  if (half == 'a' || half == 'p') {
    if (hours < 1 || hours > 12) return false;
    hours = hours % 12 + (half == 'p' ? 12 : 0);
    text = TimeText({});
  }
  ns += ((hours * 60 + minutes) * 60 + seconds) * kStampSecondNs;
  return true;
}

// Takes Z, +0100 or +01:00, if there is one.
bool take_zone(TimeText& text, std::int64_t& east_ns) {
  if (text.rest().empty() || text.take('Z')) return text.rest().empty();
  const bool west = text.rest()[0] == '-';
  std::int64_t hours = 0;
  std::int64_t minutes = 0;
  if (!west && text.rest()[0] != '+') return false;
  text.take(text.rest()[0]);
  if (text.rest().size() == 4) {
    std::int64_t both = 0;
    if (!text.number(4, 4, both)) return false;
    hours = both / 100;
    minutes = both % 100;
  } else if (!text.number(2, 2, hours) || !text.take(':') || !text.number(2, 2, minutes)) {
    return false;
  }
  east_ns = (hours * 60 + minutes) * 60 * kStampSecondNs * (west ? -1 : 1);
  return text.rest().empty();
}

// Reads milli-, micro- or nanoseconds since 1970.
std::int64_t time_of_epoch(std::string_view digits) {
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault != std::errc() || end != digits.data() + digits.size()) return kNoTime;
  switch (digits.size()) {
    case 13: return value * 1'000'000;
    case 16: return value * 1'000;
    case 19: return value;
    default: return kNoTime;
  }
}

// Reads the time of a stamp without what ends it.
void read_time(std::string_view stamp, LineStamp& out) {
  if (stamp.starts_with('[') || stamp.starts_with('(')) {
    stamp = stamp.substr(1, bracket_end(stamp) - 1);
  }
  TimeText text(stamp);
  text.skip_blanks();
  const TimeText begin = text;
  std::int64_t seconds = 0;
  std::int64_t ns = 0;
  if (text.number(1, 10, seconds) && text.take('.') && text.decimals(ns) && text.rest().empty() &&
      seconds < INT64_MAX / kStampSecondNs) {
    out.time_ns = seconds * kStampSecondNs + ns;
    return;
  }
  text = begin;
  std::int64_t days = 0;
  const bool dated = take_date(text, days);
  if (dated && !text.take('T')) text.skip_blanks();
  if (!dated) text = begin;
  std::int64_t east_ns = 0;
  if (!take_clock(text, ns) || !take_zone(text, east_ns)) return;
  constexpr std::int64_t kDaysMost = 106'000;  // 2260; time_ns ends in 2262.
  if (days < 0 || days > kDaysMost || (!dated && east_ns != 0)) return;
  out.of_day = !dated;
  out.time_ns = days * kDayNs + ns - east_ns;
}

// Returns the size of a word for "received" before bytes; 0 without one.
std::size_t marker_size(std::string_view text) {
  const std::string_view word = word_of(text);
  constexpr std::array<std::string_view, 7> kMarkers{"rx", "RX", "Rx", "rx:", "RX:", "Rx:", "<-"};
  if (std::find(kMarkers.begin(), kMarkers.end(), word) == kMarkers.end()) return 0;
  std::string_view next = word_of(text.substr(after_blanks(text, word.size())));
  if (next.starts_with("0x") || next.starts_with("0X")) next.remove_prefix(2);
  const bool hex = std::all_of(next.begin(), next.end(),
                               [](char c) { return is_hex_digit(static_cast<std::uint8_t>(c)); });
  return hex && !next.empty() && next.size() % 2 == 0 ? word.size() : 0;
}

}  // namespace

LineStamp read_stamp(Bytes line) {
  const std::string_view text(reinterpret_cast<const char*>(line.data()), line.size());
  LineStamp out;
  const std::size_t begin = after_blanks(text, 0);
  const std::string_view first = word_of(text.substr(begin));
  if (first.size() == 2 && is_hex_digit(static_cast<std::uint8_t>(first[0])))
    return out;  // A byte.
  std::size_t end = stamp_end(text.substr(begin, kStampMost));
  if (end != 0) {
    read_time(text.substr(begin, end), out);
  } else if (begins_with_epoch(text.substr(begin))) {
    end = first.size();
    out.time_ns = time_of_epoch(first);
  }
  std::size_t next = begin + end;
  const bool marked = end != 0 && next < text.size() && (text[next] == '|' || text[next] == ':');
  if (marked) ++next;  // The end of the stamp.
  if (end != 0) next = after_blanks(text, next);
  if (end != 0 && text.substr(next, 2) == "->") next = after_blanks(text, next + 2);
  const std::size_t label = label_end(text.substr(next));
  const std::size_t marker = marker_size(text.substr(next));
  if (marker != 0) out.marker = text.substr(next, marker);
  const std::size_t words = marker == 0 ? label : after_blanks(text, next + marker) - next;
  if (end != 0 || words != 0) out.size = next + words;
  return out;
}

}  // namespace rubric
