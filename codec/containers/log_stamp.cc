#include "codec/containers/log_stamp.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace rubric {
namespace {

constexpr std::size_t kStampMost = 48;
constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kBlanks = " \t";

bool is_digit(char c) { return kDigits.find(c) != kDigits.npos; }

std::string_view word_of(std::string_view text) {
  return text.substr(0, text.find_first_of(" \t\r"));
}

std::size_t after_blanks(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(kBlanks, at), text.size());
}

// Returns whether a word is as 1700000000.123.
bool is_seconds(std::string_view word) {
  const std::size_t point = word.find_first_not_of(kDigits);
  return point != 0 && point + 1 < word.size() && word[point] == '.' &&
         word.find_first_not_of(kDigits, point + 1) == word.npos;
}

// Returns whether a word is as 12:34:56, and perhaps what follows: a fraction, a zone.
bool is_clock(std::string_view word) {
  const std::size_t hours = std::min(word.find_first_not_of(kDigits), word.size());
  return (hours == 1 || hours == 2) && word.size() >= hours + 3 && word[hours] == ':' &&
         is_digit(word[hours + 1]) && is_digit(word[hours + 2]) && word.back() != ':';
}

// Returns whether a word is as 2026-11-24 or 24/11/2026.
bool is_date(std::string_view word) {
  const std::size_t first = word.find_first_of("-/");
  return first != word.npos && first != 0 && word.find(word[first], first + 1) != word.npos &&
         word.back() != word[first] &&
         word.find_first_not_of(
             std::string_view(word[first] == '-' ? "-0123456789" : "/0123456789")) == word.npos;
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
  return whole ? after_blanks(text, day + word.size()) : 0;
}

// Returns the end of the stamp itself; 0 without one.
std::size_t stamp_end(std::string_view text) {
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    const bool dated = text.substr(0, end).find_first_of(kDigits) != text.npos;
    return end != text.npos && dated ? end + 1 : 0;
  }
  std::string_view word = word_of(text);
  if (is_seconds(word)) return word.size();
  const std::size_t day_end = word.find('T');
  if (day_end != word.npos && is_date(word.substr(0, day_end)) &&
      is_clock(word.substr(day_end + 1))) {
    return word.size();
  }
  const std::size_t date = date_end(text);
  word = word_of(text.substr(date));
  return is_clock(word) ? date + word.size() : 0;
}

}  // namespace

std::size_t stamp_size(Bytes line) {
  const std::string_view text(reinterpret_cast<const char*>(line.data()), line.size());
  const std::size_t begin = after_blanks(text, 0);
  const std::size_t end = stamp_end(text.substr(begin, kStampMost));
  if (end == 0) return 0;
  const std::size_t next = after_blanks(text, begin + end);
  return text.substr(next, 2) == "->" ? after_blanks(text, next + 2) : next;
}

std::size_t mark_size(Bytes text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  const std::string_view begin(reinterpret_cast<const char*>(text.data()), text.size());
  return begin.starts_with(kMark) ? kMark.size() : 0;
}

}  // namespace rubric
