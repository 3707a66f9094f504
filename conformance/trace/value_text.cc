#include "conformance/trace/value_text.h"

#include <algorithm>
#include <charconv>

namespace rubric::trace {
namespace {

constexpr std::size_t kDigitsMax = 15;
constexpr char kHexDigits[] = "0123456789abcdef";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_word(char c) { return is_letter(c) || is_digit(c); }

int hex_digit(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Skips digits from `at` on; returns where they end.
std::size_t skip_digits(std::string_view text, std::size_t at) {
  while (at < text.size() && is_digit(text[at])) ++at;
  return at;
}

bool is_real(std::string_view text) {
  if (text == "nan" || text == "inf" || text == "-inf") return true;
  std::size_t at = text.starts_with('-') ? 1 : 0;
  const std::size_t whole = at;
  at = skip_digits(text, at);
  if (at == whole) return false;
  bool real = false;
  if (at < text.size() && text[at] == '.') {
    const std::size_t fraction = ++at;
    at = skip_digits(text, at);
    if (at == fraction) return false;
    real = true;
  }
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
    const std::size_t exponent = at;
    at = skip_digits(text, at);
    if (at == exponent) return false;
    real = true;
  }
  return real && at == text.size();
}

bool is_names(std::string_view text) {
  while (true) {
    const std::size_t bar = text.find('|');
    if (!is_name(text.substr(0, bar))) return false;
    if (bar == std::string_view::npos) return true;
    text.remove_prefix(bar + 1);
  }
}

std::string read_quoted(std::string_view text, Value& out) {
  out.kind = Value::Kind::kText;
  if (text.size() < 2 || text.back() != '"') return "text without a closing quote";
  text = text.substr(1, text.size() - 2);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') return "a quote within text is written \\\"";
    if (text[i] != '\\') {
      out.text += text[i];
    } else if (i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\')) {
      out.text += text[++i];
    } else if (i + 3 < text.size() && text[i + 1] == 'x' &&
               read_hex_bytes(text.substr(i + 2, 2), out.text)) {
      i += 3;
    } else {
      return "in text a backslash comes before \", \\ or x and two hex digits";
    }
  }
  return {};
}

// Reads a half of an address or of a channel.
bool read_half(std::string_view text, Value& out) {
  if (text == "*") {
    out = Value::any();
  } else if (text.starts_with('$') && is_name(text.substr(1))) {
    out = Value::variable(text.substr(1));
  } else if (is_name(text)) {
    out = Value::names(text);
  } else if (is_digit(text.empty() ? ' ' : text[0]) && read_integer(text, out.number)) {
    out.kind = Value::Kind::kNumber;
    out.hex = text.starts_with("0x");
  } else {
    return false;
  }
  return true;
}

std::string read_pair(std::string_view text, std::size_t at, std::size_t size, Value& out) {
  out.items.resize(2);
  if (read_half(text.substr(0, at), out.items[0]) &&
      read_half(text.substr(at + size), out.items[1])) {
    return {};
  }
  return "expected a number, a name, a variable or * on each side of '" +
         std::string(text.substr(at, size)) + "'";
}

std::string read_list(std::string_view text, Value& out) {
  out.kind = Value::Kind::kList;
  if (text.size() < 2 || text.back() != ']') return "a list without its closing bracket";
  text = text.substr(1, text.size() - 2);
  while (true) {
    while (!text.empty() && (text[0] == ' ' || text[0] == '\t')) text.remove_prefix(1);
    if (text.empty()) return {};
    if (text[0] == '[') return "a list within a list";
    const std::size_t size = value_size(text);
    if (size == 0) return "unexpected '" + std::string(text.substr(0, 1)) + "' in a list";
    const std::string problem = read_value(text.substr(0, size), out.items.emplace_back());
    if (!problem.empty()) return problem;
    text.remove_prefix(size);
  }
}

std::string read_number(std::string_view text, Value& out) {
  if (read_integer(text, out.number)) {
    out.kind = Value::Kind::kNumber;
    out.hex = text.starts_with("0x");
    return {};
  }
  return "expected a number of at most " + std::to_string(kDigitsMax) + " digits, given '" +
         std::string(text) + "'";
}

// Reads `$t+5` or `$t-5`.
bool read_shift(std::string_view text, std::string& name, std::int64_t& shift) {
  const std::size_t sign = text.find_first_of("+-");
  if (!text.starts_with('$') || sign == std::string_view::npos) return false;
  name = text.substr(1, sign - 1);
  const std::string_view digits = text.substr(sign + 1);
  if (!is_name(name) || digits.empty() || !is_digit(digits[0]) || digits.starts_with("0x") ||
      !read_integer(digits, shift)) {
    return false;
  }
  if (text[sign] == '-') shift = -shift;
  return true;
}

// Reads `$t+5..$t+9`.
std::string read_shifted(std::string_view text, Value& out) {
  const std::string quoted = "'" + std::string(text) + "'";
  const std::size_t at = text.find("..");
  out.kind = Value::Kind::kRange;
  std::string second;
  if (!read_shift(text.substr(0, at), out.text, out.number) ||
      !read_shift(text.substr(at + 2), second, out.max)) {
    return "expected a range of numbers, as $t+5..$t+9, given " + quoted;
  }
  if (second != out.text) return "a range of numbers from one variable to another: " + quoted;
  return out.number <= out.max ? "" : "the range " + quoted + " is empty";
}

std::string read_plain(std::string_view text, Value& out) {
  using Kind = Value::Kind;
  const std::string quoted = "'" + std::string(text) + "'";
  if (text.empty()) return "expected a value";
  if (text == "*") return {};
  if (text[0] == '"') return read_quoted(text, out);
  if (text[0] == '[') return read_list(text, out);
  if (const std::size_t at = text.find("->"); at != std::string_view::npos) {
    out.kind = Kind::kChannel;
    return read_pair(text, at, 2, out);
  }
  if (const std::size_t at = text.find(':'); at != std::string_view::npos) {
    out.kind = Kind::kAddress;
    return read_pair(text, at, 1, out);
  }
  if (text[0] == '$' && text.find("..") != std::string_view::npos) return read_shifted(text, out);
  if (read_shift(text, out.text, out.number)) {
    out.kind = Kind::kRange;
    out.max = out.number;
    return {};
  }
  out.text.clear();
  if (text[0] == '$') {
    out.kind = Kind::kVariable;
    out.text = text.substr(1);
    return is_name(out.text) ? "" : "expected a variable's name after '$', given " + quoted;
  }
  if (text[0] == 'x' && read_hex_bytes(text.substr(1), out.text)) {
    out.kind = Kind::kBytes;
    return {};
  }
  out.text.clear();
  if (const std::size_t at = text.find(".."); at != std::string_view::npos) {
    out.kind = Kind::kRange;
    if (!read_integer(text.substr(0, at), out.number) ||
        !read_integer(text.substr(at + 2), out.max)) {
      return "expected a range of numbers, given " + quoted;
    }
    return out.number <= out.max ? "" : "the range " + quoted + " is empty";
  }
  if (is_real(text)) {
    out.kind = Kind::kReal;
    out.text = text;
    return {};
  }
  if (is_digit(text[0]) || text[0] == '-') return read_number(text, out);
  out.kind = Kind::kNames;
  out.text = text;
  return is_names(text) ? "" : "expected a value, given " + quoted;
}

}  // namespace

bool read_hex_bytes(std::string_view digits, std::string& out) {
  if (digits.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = hex_digit(digits[i]);
    const int low = hex_digit(digits[i + 1]);
    if (high < 0 || low < 0) return false;
    out += static_cast<char>(high << 4 | low);
  }
  return true;
}

bool read_integer(std::string_view text, std::int64_t& out) {
  const bool hex = text.starts_with("0x");
  if (hex) text.remove_prefix(2);
  if (text.empty() || (hex && text[0] == '-') || text.size() > kDigitsMax) return false;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out, hex ? 16 : 10);
  return error == std::errc{} && stop == end;
}

bool is_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), is_word);
}

bool is_dotted_name(std::string_view text) {
  return !text.empty() && is_word(text[0]) && text.back() != '.' &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return is_word(c) || c == '-' || c == '.'; });
}

bool is_path(std::string_view text) {
  while (true) {
    const std::size_t dot = text.find('.');
    std::string_view part = text.substr(0, dot);
    if (part.ends_with(']')) {
      const std::size_t open = part.find('[');
      if (open == std::string_view::npos) return false;
      const std::string_view index = part.substr(open + 1, part.size() - open - 2);
      // Indexes are counted without leading zeros, so that a path has one spelling.
      if (index.empty() || index.size() > 3 || (index[0] == '0' && index.size() > 1) ||
          !std::all_of(index.begin(), index.end(), is_digit)) {
        return false;
      }
      part = part.substr(0, open);
    }
    if (!is_name(part)) return false;
    if (dot == std::string_view::npos) return true;
    text.remove_prefix(dot + 1);
  }
}

std::size_t value_size(std::string_view text) {
  bool quoted = false;
  bool bracket = false;
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (bracket) {
      bracket = c != ']';
    } else if (c == '[') {
      bracket = true;
    } else if (c == ' ' || c == '\t' || c == ')' || c == ']') {
      break;
    }
  }
  return std::min(i, text.size());
}

std::string read_value(std::string_view text, Value& out) {
  out = Value{};
  const bool negated = text.starts_with('!');
  if (negated) text.remove_prefix(1);
  if (negated && text == "*") return "nothing is other than *";
  if (negated && text.starts_with('!')) return "'!' is given twice";
  std::string problem = read_plain(text, out);
  out.negated = negated;
  return problem;
}

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

void put_hex(std::string_view bytes, std::string& out) {
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    out += kHexDigits[byte >> 4];
    out += kHexDigits[byte & 15];
  }
}

namespace {

void put_integer(std::int64_t number, bool hex, std::string& out) {
  char text[24];
  const auto result = std::to_chars(text, text + sizeof text, number, hex ? 16 : 10);
  if (hex) out += "0x";
  out.append(text, result.ptr);
}

// Prints an end of a range, perhaps relative to a variable.
void put_bound(std::string_view variable, std::int64_t number, std::string& out) {
  if (!variable.empty()) {
    out += '$';
    out += variable;
    if (number >= 0) out += '+';
  }
  put_integer(number, false, out);
}

void put_quoted(std::string_view text, std::string& out) {
  out += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c >= ' ' && c < 0x7F) {
      out += c;
    } else {
      out += "\\x";
      put_hex({&c, 1}, out);
    }
  }
  out += '"';
}

void put_pair(const Value& value, std::string_view between, std::string& out) {
  put_value(value.items[0], out);
  out += between;
  put_value(value.items[1], out);
}

}  // namespace

void put_value(const Value& value, std::string& out) {
  if (value.negated) out += '!';
  switch (value.kind) {
    case Value::Kind::kAny: out += '*'; return;
    case Value::Kind::kNumber: return put_integer(value.number, value.hex, out);
    case Value::Kind::kRange:
      put_bound(value.text, value.number, out);
      if (!value.text.empty() && value.number == value.max) return;
      out += "..";
      return put_bound(value.text, value.max, out);
    case Value::Kind::kReal:
    case Value::Kind::kNames: out += value.text; return;
    case Value::Kind::kBytes: out += 'x'; return put_hex(value.text, out);
    case Value::Kind::kText: return put_quoted(value.text, out);
    case Value::Kind::kVariable:
      out += '$';
      out += value.text;
      return;
    case Value::Kind::kAddress: return put_pair(value, ":", out);
    case Value::Kind::kChannel: return put_pair(value, "->", out);
    case Value::Kind::kList:
      out += '[';
      for (std::size_t i = 0; i < value.items.size(); ++i) {
        if (i) out += ' ';
        put_value(value.items[i], out);
      }
      out += ']';
      return;
  }
}

std::string value_text(const Value& value) {
  std::string text;
  put_value(value, text);
  return text;
}

}  // namespace rubric::trace
