#include "fuzz/support/json_check.h"

#include <cstddef>

namespace rubric::fuzz {
namespace {

constexpr int kMaxDepth = 64;

/// Each function takes its part off the front of the text; returns false if there is none.
class Judge {
 public:
  using Members = std::map<std::string_view, std::string_view>;

  Judge(std::string_view text, Members* members) : text_(text), members_(members) {}

  bool all() { return value(0) && (space(), at_ == text_.size()); }

 private:
  char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool take(char c) {
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  bool word(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }
  void space() {
    while (next() == ' ' || next() == '\t' || next() == '\n' || next() == '\r') ++at_;
  }
  bool digits() {
    const std::size_t begin = at_;
    while (next() >= '0' && next() <= '9') ++at_;
    return at_ != begin;
  }

  bool number() {
    take('-');
    if (!take('0') && !digits()) return false;
    if (take('.') && !digits()) return false;
    if (!take('e') && !take('E')) return true;
    if (!take('+')) take('-');
    return digits();
  }

  // The Unicode Standard, table 3-7: well-formed byte sequences.
  bool character() {
    const auto byte = [&](std::size_t i) {
      return at_ + i < text_.size() ? static_cast<unsigned char>(text_[at_ + i]) : 0u;
    };
    const unsigned first = byte(0);
    unsigned low = 0x80;
    unsigned high = 0xBF;
    std::size_t more = 0;
    if (first >= 0xC2 && first <= 0xDF) more = 1;
    if (first >= 0xE0 && first <= 0xEF) more = 2;
    if (first >= 0xF0 && first <= 0xF4) more = 3;
    if (first >= 0x80 && more == 0) return false;
    if (first == 0xE0) low = 0xA0;
    if (first == 0xED) high = 0x9F;
    if (first == 0xF0) low = 0x90;
    if (first == 0xF4) high = 0x8F;
    for (std::size_t i = 1; i <= more; ++i) {
      if (byte(i) < low || byte(i) > high) return false;
      low = 0x80;
      high = 0xBF;
    }
    at_ += 1 + more;
    return first >= 0x20;
  }

  // Takes the four digits after \u.
  bool unit(unsigned* value) {
    *value = 0;
    for (int i = 0; i < 4; ++i, ++at_) {
      const char c = next();
      const char lower = static_cast<char>(c | 0x20);
      if (c >= '0' && c <= '9') {
        *value = *value * 16 + static_cast<unsigned>(c - '0');
      } else if (lower >= 'a' && lower <= 'f') {
        *value = *value * 16 + static_cast<unsigned>(lower - 'a') + 10;
      } else {
        return false;
      }
    }
    return true;
  }

  bool escape() {
    if (!take('u')) {
      const bool known = std::string_view("\"\\/bfnrt").find(next()) != std::string_view::npos;
      ++at_;
      return known;
    }
    unsigned first = 0;
    unsigned second = 0;
    if (!unit(&first) || (first >= 0xDC00 && first <= 0xDFFF)) return false;
    if (first < 0xD800 || first > 0xDBFF) return true;
    return word("\\u") && unit(&second) && second >= 0xDC00 && second <= 0xDFFF;
  }

  bool string() {
    if (!take('"')) return false;
    while (!take('"')) {
      if (at_ == text_.size() || !(take('\\') ? escape() : character())) return false;
    }
    return true;
  }

  bool object(int depth) {
    if (!take('{')) return false;
    for (bool first = true; space(), !take('}'); first = false) {
      if (!first && !take(',')) return false;
      space();
      const std::size_t key_at = at_ + 1;
      if (!string()) return false;
      const std::string_view key = text_.substr(key_at, at_ - 1 - key_at);
      space();
      if (!take(':')) return false;
      space();
      const std::size_t value_at = at_;
      if (!value(depth + 1)) return false;
      if (depth == 0 && members_ != nullptr) {
        members_->emplace(key, text_.substr(value_at, at_ - value_at));
      }
    }
    return true;
  }

  bool array(int depth) {
    if (!take('[')) return false;
    for (bool first = true; space(), !take(']'); first = false) {
      if ((!first && !take(',')) || !value(depth + 1)) return false;
    }
    return true;
  }

  bool value(int depth) {
    space();
    if (depth > kMaxDepth) return false;
    switch (next()) {
      case '{':
        return object(depth);
      case '[':
        return array(depth);
      case '"':
        return string();
      case 't':
        return word("true");
      case 'f':
        return word("false");
      case 'n':
        return word("null");
      default:
        return number();
    }
  }

  std::string_view text_;
  Members* members_;
  std::size_t at_ = 0;
};

}  // namespace

bool is_json(std::string_view text, std::map<std::string_view, std::string_view>* members) {
  return Judge(text, members).all();
}

}  // namespace rubric::fuzz
