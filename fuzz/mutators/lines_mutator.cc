#include "fuzz/mutators/lines_mutator.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <random>
#include <string>
#include <string_view>

#include "fuzz/support/mutate_bytes.h"

namespace rubric::fuzz {
namespace {

class Slips {
 public:
  Slips(std::string text, unsigned seed) : text_(std::move(text)), random_(seed) {}

  void slip() {
    switch (below(6)) {
      case 0: return double_line();
      case 1: return drop_line();
      case 2: return swap_lines();
      case 3: return take_value();
      case 4: return take_word();
      default: return take_number();
    }
  }
  const std::string& text() const { return text_; }

 private:
  struct Span {
    std::size_t at = 0;
    std::size_t size = 0;
  };

  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  std::string at(Span span) const { return text_.substr(span.at, span.size); }
  void put(Span where, const std::string& what) { text_.replace(where.at, where.size, what); }

  /// Returns a line with its end.
  Span line() {
    if (text_.empty()) return {};
    const std::size_t inside = below(text_.size());
    const std::size_t before = inside == 0 ? std::string::npos : text_.rfind('\n', inside - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = text_.find('\n', inside);
    return {begin, (end == std::string::npos ? text_.size() : end + 1) - begin};
  }
  static bool in_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.' ||
           c == '$';
  }
  Span word() {
    if (text_.empty()) return {};
    std::size_t begin = below(text_.size());
    while (begin < text_.size() && !in_word(text_[begin])) ++begin;
    while (begin > 0 && begin < text_.size() && in_word(text_[begin - 1])) --begin;
    std::size_t end = begin;
    while (end < text_.size() && in_word(text_[end])) ++end;
    return {begin, end - begin};
  }
  /// Returns the text after the first `: ` or `=` of a line, or all of it.
  Span value() {
    const Span whole = line();
    const std::string_view content(text_.data() + whole.at, whole.size);
    const std::size_t colon = content.find(": ");
    const std::size_t equals = content.find('=');
    std::size_t from = 0;
    if (colon != content.npos) from = colon + 2;
    if (equals != content.npos && (colon == content.npos || below(2) == 0)) from = equals + 1;
    std::size_t size = content.size() - from;
    if (size > 0 && content.back() == '\n') --size;
    return {whole.at + from, size};
  }

  void double_line() {
    const std::string copy = at(line());
    text_.insert(line().at, copy);
  }
  void drop_line() { put(line(), ""); }
  void swap_lines() {
    Span a = line();
    Span b = line();
    if (a.at > b.at) std::swap(a, b);
    if (a.at == b.at) return;
    const std::string first = at(a);
    const std::string second = at(b);
    put(b, first);
    put(a, second);
  }
  void take_value() {
    const std::string other = at(value());
    put(value(), other);
  }
  void take_word() {
    const std::string other = at(word());
    put(word(), other);
  }
  void take_number() {
    constexpr const char* kNumbers[] = {"0",
                                        "1",
                                        "-1",
                                        "2",
                                        "255",
                                        "256",
                                        "65535",
                                        "65536",
                                        "0x1f",
                                        "1024",
                                        "2147483647",
                                        "2147483648",
                                        "4294967295",
                                        "4294967296",
                                        "1e9",
                                        "-0",
                                        "999999999999999",
                                        "9223372036854775807",
                                        "9223372036854775808",
                                        "18446744073709551615",
                                        "0.5",
                                        "nan"};
    put(word(), kNumbers[below(std::size(kNumbers))]);
  }

  std::string text_;
  std::minstd_rand random_;
};

}  // namespace

std::size_t mutate_lines(std::uint8_t* data, std::size_t size, std::size_t max_size,
                         unsigned seed) {
  std::minstd_rand random(seed);
  if (random() % 3 == 0) return mutate_bytes(data, size, max_size, seed);
  Slips slips(std::string(reinterpret_cast<const char*>(data), size),
              static_cast<unsigned>(random()));
  for (auto left = 1 + random() % 3; left > 0; --left) slips.slip();
  const std::size_t kept = std::min(slips.text().size(), max_size);
  if (kept > 0) std::memcpy(data, slips.text().data(), kept);
  return kept;
}

}  // namespace rubric::fuzz
