#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "codec/reflect/suggest.h"
#include "tools/format/filter.h"

namespace rubric::format {
namespace {

/// Deeper nesting is a mistake or an attack; the parser recurses once a level.
constexpr int kMaxDepth = 64;
constexpr std::size_t kMaxChars = 64 * 1024;

enum class TokenKind : std::uint8_t { kEnd, kWord, kNumber, kString, kSymbol };
struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string_view text;  // For a string: without its quotes.
  std::size_t position = 0;
};

bool starts_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Names of interfaces have colons, those of requirements hyphens.
bool continues_word(char c) {
  return starts_word(c) || is_digit(c) || c == '.' || c == ':' || c == '-';
}

/// Splits an expression into tokens.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) {
      ++at_;
    }
    if (at_ == text_.size()) return {TokenKind::kEnd, {}, at_};
    const char c = text_[at_];
    if (starts_word(c)) return take(TokenKind::kWord, length_while(continues_word));
    if (c == '"' || c == '\'') return string(c);
    if (is_digit(c) || (c == '-' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) {
      return take(TokenKind::kNumber, number_length());
    }
    for (const std::string_view symbol : {"==", "!=", "<=", ">=", "&&", "||"}) {
      if (text_.substr(at_).starts_with(symbol)) return take(TokenKind::kSymbol, 2);
    }
    if (c == '=') throw FilterError("'=' is not a comparison, '==' is", at_);
    if (std::string_view("<>!()&|").find(c) != std::string_view::npos) {
      return take(TokenKind::kSymbol, 1);
    }
    if (c < ' ' || c > '~') throw FilterError("this character means nothing here", at_);
    throw FilterError(fmt::format("'{}' means nothing here", c), at_);
  }

 private:
  Token take(TokenKind kind, std::size_t size) {
    const Token token{kind, text_.substr(at_, size), at_};
    at_ += size;
    return token;
  }
  template <class Is>
  std::size_t length_while(Is is) const {
    std::size_t end = at_;
    while (end < text_.size() && is(text_[end])) ++end;
    return end - at_;
  }
  // Returns the length of everything that could be meant as one number; reading it reports errors.
  std::size_t number_length() const {
    std::size_t end = at_ + 1;
    while (end < text_.size()) {
      const char c = text_[end];
      const bool exponent_sign = (c == '-' || c == '+') && (text_[end - 1] | 0x20) == 'e';
      if (!continues_word(c) && !exponent_sign) break;
      if (c == '-' && !exponent_sign) break;
      ++end;
    }
    return end - at_;
  }
  Token string(char quote) {
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) throw FilterError("this string does not end", at_);
    const Token token{TokenKind::kString, text_.substr(at_ + 1, end - at_ - 1), at_};
    at_ = end + 1;
    return token;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

bool is_symbol(const Token& token, std::string_view text) {
  return token.kind == TokenKind::kSymbol && token.text == text;
}
bool is_word(const Token& token, std::string_view text) {
  return token.kind == TokenKind::kWord && token.text == text;
}

std::optional<Compare> comparison(const Token& token) {
  constexpr std::pair<std::string_view, Compare> kAll[] = {
      {"==", Compare::kEq}, {"!=", Compare::kNe}, {"<", Compare::kLt},
      {"<=", Compare::kLe}, {">", Compare::kGt},  {">=", Compare::kGe}};
  for (const auto& [text, op] : kAll) {
    if (is_symbol(token, text)) return op;
  }
  return std::nullopt;
}

Compare mirrored(Compare op) {
  switch (op) {
    case Compare::kLt: return Compare::kGt;
    case Compare::kLe: return Compare::kGe;
    case Compare::kGt: return Compare::kLt;
    case Compare::kGe: return Compare::kLe;
    default: return op;
  }
}

std::uint64_t read_hex(const Token& token) {
  std::uint64_t value = 0;
  const char* end = token.text.data() + token.text.size();
  const auto [stop, error] = std::from_chars(token.text.data() + 2, end, value, 16);
  if (error != std::errc{} || stop != end) {
    throw FilterError(fmt::format("'{}' is not a number", token.text), token.position);
  }
  return value;
}

Operand of_whole(reflect::Whole value) {
  Operand operand{.halves = 2 * value, .real = static_cast<double>(value)};
  return operand;
}

// Returns Operand::halves of a decimal; one beyond 64 bits is beyond all numbers that it meets.
reflect::Whole halves_of(std::string_view text) {
  constexpr reflect::Whole kBeyond = reflect::Whole{1} << 66;
  const bool negative = text.starts_with('-');
  text.remove_prefix(negative);
  const std::size_t end = std::min(text.find_first_of("eE"), text.size());
  std::size_t whole_digits = std::min(text.find('.'), end);
  int exponent = 0;
  if (end < text.size()) {
    const char* const from = text.data() + end + 1 + (text[end + 1] == '+');
    std::from_chars(from, text.data() + text.size(), exponent);
  }
  reflect::Whole whole = 0;
  bool rest = false;
  auto left = static_cast<std::ptrdiff_t>(whole_digits) + exponent;
  for (const char c : text.substr(0, end)) {
    if (c == '.') continue;
    if (left-- > 0) {
      whole = std::min(10 * whole + (c - '0'), kBeyond);
    } else {
      rest = rest || c != '0';
    }
  }
  for (; left > 0 && whole > 0 && whole < kBeyond; --left) whole *= 10;
  const reflect::Whole halves = 2 * std::min(whole, kBeyond) + rest;
  return negative ? -halves : halves;
}

Operand read_number(const Token& token) {
  Operand operand;
  const char* begin = token.text.data();
  const char* end = begin + token.text.size();
  if (token.text.starts_with("0x") || token.text.starts_with("0X")) {
    return of_whole(read_hex(token));
  }
  std::uint64_t unsigned_value = 0;
  const auto natural = std::from_chars(begin, end, unsigned_value);
  if (natural.ec == std::errc{} && natural.ptr == end) return of_whole(unsigned_value);
  std::int64_t signed_value = 0;
  const auto whole = std::from_chars(begin, end, signed_value);
  if (whole.ec == std::errc{} && whole.ptr == end) return of_whole(signed_value);
  const bool too_long = natural.ec == std::errc::result_out_of_range && natural.ptr == end;
  if (too_long || (whole.ec == std::errc::result_out_of_range && whole.ptr == end)) {
    // The nearest double would be equal to numbers that are not it.
    throw FilterError(fmt::format("'{}' is beyond 64 bits", token.text), token.position);
  }
  operand.kind = Operand::Kind::kReal;
  const auto real = std::from_chars(begin, end, operand.real);
  if (real.ec != std::errc{} || real.ptr != end) {
    throw FilterError(fmt::format("'{}' is not a number", token.text), token.position);
  }
  operand.halves = halves_of(token.text);
  return operand;
}

}  // namespace

/// Recursive descent: any of all of (not | in parentheses | comparison).
class FilterParser {
 public:
  FilterParser(std::string_view text, const reflect::Protocol& protocol, Filter& filter)
      : lexer_(text), protocol_(protocol), filter_(filter) {
    if (text.size() > kMaxChars) {
      throw FilterError(fmt::format("the expression is longer than {} characters", kMaxChars), 0);
    }
    token_ = lexer_.next();
  }

  std::size_t parse() {
    const std::size_t term = any(0);
    if (token_.kind == TokenKind::kEnd) return term;
    if (is_symbol(token_, ")")) fail("there is no '(' for this ')'");
    if (is_symbol(token_, "|")) fail("'|' joins the bits of a mask; '||' is or");
    fail("expected '&&', '||' or the end");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FilterError(what, token_.position);
  }
  void advance() { token_ = lexer_.next(); }
  bool skip(std::string_view symbol) {
    if (!is_symbol(token_, symbol)) return false;
    advance();
    return true;
  }
  std::size_t add(Term term) {
    filter_.terms_.push_back(std::move(term));
    return filter_.terms_.size() - 1;
  }
  static Term group(Term::Kind kind, std::vector<std::size_t> parts) {
    return {.kind = kind, .parts = std::move(parts)};
  }

  std::size_t any(int depth) {
    std::vector<std::size_t> parts{all(depth)};
    while (is_symbol(token_, "||") || is_word(token_, "or")) {
      advance();
      parts.push_back(all(depth));
    }
    return parts.size() == 1 ? parts[0] : add(group(Term::Kind::kAny, std::move(parts)));
  }

  std::size_t all(int depth) {
    std::vector<std::size_t> parts{unary(depth)};
    while (is_symbol(token_, "&&") || is_word(token_, "and")) {
      advance();
      parts.push_back(unary(depth));
    }
    return parts.size() == 1 ? parts[0] : add(group(Term::Kind::kAll, std::move(parts)));
  }

  std::size_t unary(int depth) {
    if (depth > kMaxDepth) fail("this is nested too deeply");
    if (is_symbol(token_, "!") || is_word(token_, "not")) {
      advance();
      return add(group(Term::Kind::kNot, {unary(depth + 1)}));
    }
    if (skip("(")) {
      const std::size_t term = any(depth + 1);
      if (!skip(")")) fail("expected ')'");
      return term;
    }
    return comparison_or_presence();
  }

  std::size_t comparison_or_presence() {
    Term term;
    if (token_.kind == TokenKind::kNumber || token_.kind == TokenKind::kString) {
      return literal_first();
    }
    if (token_.kind != TokenKind::kWord) {
      fail(token_.kind == TokenKind::kEnd ? "expected a name here, the expression ends"
                                          : "expected a name");
    }
    const Token name = token_;
    advance();
    if (name.text == "exists" && skip("(")) {
      if (token_.kind != TokenKind::kWord) fail("expected a name");
      term.kind = Term::Kind::kPresent;
      term.path = path(token_);
      advance();
      if (!skip(")")) fail("expected ')'");
      return add(std::move(term));
    }
    term.path = path(name);
    if (skip("&")) mask(term);
    const std::optional<Compare> op = comparison(token_);
    term.kind = op ? Term::Kind::kCompare : Term::Kind::kPresent;
    if (op) {
      advance();
      term.compare = *op;
      operand(term);
      advance();
    }
    return add(std::move(term));
  }

  // 4 == src.devid
  std::size_t literal_first() {
    const Token literal = token_;
    advance();
    const std::optional<Compare> op = comparison(token_);
    if (!op) fail("expected a comparison");
    advance();
    if (token_.kind != TokenKind::kWord) fail("expected a name");
    Term term{.kind = Term::Kind::kCompare, .path = path(token_), .compare = mirrored(*op)};
    const Token name = token_;
    token_ = literal;
    operand(term);
    token_ = name;
    advance();
    return add(std::move(term));
  }

  std::size_t path(const Token& token) {
    try {
      filter_.paths_.emplace_back(token.text, protocol_);
    } catch (const PathError& error) {
      throw FilterError(error.what(), token.position);
    }
    return filter_.paths_.size() - 1;
  }

  // light|temp, 0x43
  void mask(Term& term) {
    term.masked = true;
    const std::vector<std::string> bits = filter_.paths_[term.path].bit_names();
    do {
      if (token_.kind == TokenKind::kWord && bits.empty()) {
        fail(fmt::format("{} is not a mask, its bits have no names",
                         filter_.paths_[term.path].text()));
      }
      if (token_.kind == TokenKind::kNumber) {
        const Operand number = read_number(token_);
        if (number.kind != Operand::Kind::kInteger) fail("a mask is a whole number");
        term.mask |= static_cast<std::int64_t>(number.halves / 2);
      } else if (token_.kind == TokenKind::kWord) {
        const std::string name(token_.text);
        if (std::find(bits.begin(), bits.end(), name) == bits.end()) {
          fail(fmt::format("unknown bit '{}'{}", name, reflect::did_you_mean(name, bits)));
        }
        term.mask_bits.push_back(name);
      } else {
        fail("expected a bit's name or a number");
      }
      advance();
    } while (skip("|"));
  }

  // Reads the present token without leaving it.
  void operand(Term& term) {
    const Path& left = filter_.paths_[term.path];
    switch (token_.kind) {
      case TokenKind::kNumber:
        if (left.is_free_text() && !term.masked) {
          // Hex of bytes may look like a number.
          term.operand.kind = Operand::Kind::kText;
          term.operand.text = token_.text;
          break;
        }
        term.operand = read_number(token_);
        return;
      case TokenKind::kString:
        term.operand.kind = Operand::Kind::kText;
        term.operand.text = token_.text;
        break;
      case TokenKind::kWord:
        if (word(term, left)) return;
        break;
      default: fail("expected a number, a name or a string");
    }
    if (left.is_bytes() && !term.masked) hex(term.operand.text);
    if (term.compare != Compare::kEq && term.compare != Compare::kNe) {
      fail("names and text compare by == and != alone");
    }
  }

  // Reads the bytes to compare with; 0x may precede them, as it may precede numbers.
  void hex(std::string& text) const {
    if (text.starts_with("0x") || text.starts_with("0X")) text.erase(0, 2);
    const bool digits = text.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
    if (!digits || text.size() % 2 != 0) fail("bytes compare with hex digits, two a byte");
  }

  // Reads a name that the left side can have, else another path; returns true if it was a path.
  bool word(Term& term, const Path& left) {
    const std::string name(token_.text);
    const std::vector<std::string> names = left.names();
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    if (known || left.is_free_text()) {
      term.operand.kind = Operand::Kind::kText;
      term.operand.text = name;
      return false;
    }
    const std::vector<std::string> bits = left.bit_names();
    if (std::find(bits.begin(), bits.end(), name) != bits.end()) {
      fail(fmt::format("'{0}' is a bit of {1}: '{1} & {0}' asks for it", name, left.text()));
    }
    // A lone word beside something with named values is meant as such a name, not as a path.
    if (!names.empty() && name.find('.') == std::string::npos) {
      const std::string hint = reflect::did_you_mean(name, names);
      fail(fmt::format("{} is never '{}'{}", left.text(), name, hint));
    }
    try {
      Path right(name, protocol_);
      term.operand.kind = Operand::Kind::kPath;
      term.operand.path = filter_.paths_.size();
      filter_.paths_.push_back(std::move(right));
      return true;
    } catch (const PathError& error) {
      fail(error.what());
    }
  }

  Lexer lexer_;
  const reflect::Protocol& protocol_;
  Filter& filter_;
  Token token_;
};

Filter::Filter(std::string_view expression, const reflect::Protocol& protocol) {
  root_ = FilterParser(expression, protocol, *this).parse();
}

}  // namespace rubric::format
