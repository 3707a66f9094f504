#include "codec/text/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace rubric::text {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD.

char* put(char* at, std::string_view text) {
  std::memcpy(at, text.data(), text.size());
  return at + text.size();
}

bool continues(std::string_view text, std::size_t i) {
  return (static_cast<std::uint8_t>(text[i]) & 0xc0) == 0x80;
}

// Returns whether a terminal obeys this character instead of showing it: those that control it,
// U+0080 to U+009F among them, and those that turn the direction of writing.
bool obeyed(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7f;
  if (character.size() == 2) return byte(0) == 0xc2 && byte(1) < 0xa0;
  if (character.size() != 3 || byte(0) != 0xe2) return false;
  if (byte(1) == 0x80) {
    return byte(2) == 0x8e || byte(2) == 0x8f || (byte(2) >= 0xa8 && byte(2) <= 0xae);
  }
  return byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9;
}

char* put_escape(char* at, std::uint8_t c) {
  switch (c) {
    case '"': return put(at, "\\\"");
    case '\\': return put(at, "\\\\");
    case '\n': return put(at, "\\n");
    case '\r': return put(at, "\\r");
    case '\t': return put(at, "\\t");
    default: break;
  }
  at = put(at, "\\u00");
  *at++ = "0123456789abcdef"[c >> 4];
  *at++ = "0123456789abcdef"[c & 15];
  return at;
}

}  // namespace

std::string seconds_text(std::int64_t time_us) {
  if (time_us < 0) return {};
  return fmt::format("{}.{:06}", time_us / 1'000'000, time_us % 1'000'000);
}

std::string counted(std::uint64_t number, std::string_view singular, std::string_view plural) {
  if (number == 1) return fmt::format("1 {}", singular);
  if (plural.empty()) return fmt::format("{} {}s", number, singular);
  return fmt::format("{} {}", number, plural);
}

std::string wrapped(std::string_view first, std::string_view text, std::size_t width,
                    std::size_t hang) {
  return broken_at_blanks(harmless(first), harmless(text, Keep::kLines), width, hang);
}

std::string broken_at_blanks(std::string_view first, std::string_view text, std::size_t width,
                             std::size_t hang) {
  std::string out(first);
  std::size_t column = first.size();
  bool fresh = true;  // The line is empty yet.
  while (!text.empty()) {
    const std::size_t begin = text.find_first_not_of(" \n\t\r");
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(" \n\t\r"));
    text.remove_prefix(word.size());
    if (!fresh && column + 1 + word.size() > width) {
      out += '\n';
      out.append(hang, ' ');
      column = hang;
      fresh = true;
    }
    if (!fresh) out += ' ', ++column;
    out += word;
    column += word.size();
    fresh = false;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out + '\n';
}

std::string painted(const TextStyle& look, std::string_view style, std::string_view text) {
  return look.color ? fmt::format("\033[{}m{}\033[0m", style, text) : std::string(text);
}

std::string in_capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 32 : c); });
  return out;
}

std::string styled(const TextStyle& look, std::string_view style, std::string_view head,
                   std::string_view rest) {
  const std::string lines =
      wrapped("", fmt::format("{} {}", head, rest), look.width, kIndent.size());
  return painted(look, style, head) + lines.substr(head.size());
}

std::string field(std::string_view name, std::string_view text, const TextStyle& look) {
  if (text.empty()) return {};
  return wrapped(fmt::format("{}{:<9} ", kIndent, name), text, look.width);
}

std::size_t utf8_length(std::string_view text) {
  if (text.empty()) return 0;
  const auto first = static_cast<std::uint8_t>(text[0]);
  if (first < 0x80) return 1;
  if (first < 0xc2 || first > 0xf4) return 0;
  const std::size_t length = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (!continues(text, i)) return 0;
  }
  const auto second = static_cast<std::uint8_t>(text[1]);
  // Longer than needed, surrogates, beyond U+10FFFF.
  if (first == 0xe0 && second < 0xa0) return 0;
  if (first == 0xed && second > 0x9f) return 0;
  if (first == 0xf0 && second < 0x90) return 0;
  if (first == 0xf4 && second > 0x8f) return 0;
  return length;
}

char* put_json_string(char* at, std::string_view text) {
  *at++ = '"';
  while (!text.empty()) {
    const auto c = static_cast<std::uint8_t>(text[0]);
    if (c < 0x20 || c == '"' || c == '\\' || c == 0x7f) {
      at = put_escape(at, c);
      text.remove_prefix(1);
      continue;
    }
    const std::size_t length = utf8_length(text);
    at = length ? put(at, text.substr(0, length)) : put(at, kReplacement);
    text.remove_prefix(length ? length : 1);
  }
  *at++ = '"';
  return at;
}

std::string json_string(std::string_view text) {
  std::string out(6 * text.size() + 2, '\0');
  out.resize(static_cast<std::size_t>(put_json_string(out.data(), text) - out.data()));
  return out;
}

std::string xml_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view c = length == 0 ? kReplacement : text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
    const bool forbidden =
        (static_cast<std::uint8_t>(c.front()) < 0x20 && c != "\n" && c != "\t") ||
        c == "\xEF\xBF\xBE" || c == "\xEF\xBF\xBF";
    if (c == "&") {
      out += "&amp;";
    } else if (c == "<") {
      out += "&lt;";
    } else if (c == ">") {
      out += "&gt;";
    } else if (c == "\"") {
      out += "&quot;";
    } else {
      out += forbidden ? kReplacement : c;
    }
  }
  return out;
}

std::string harmless(std::string_view text, Keep keep) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view character = text.substr(0, length);
    const bool kept = keep == Keep::kLines && (character == "\n" || character == "\t");
    out += kept || (length != 0 && !obeyed(character)) ? character : kReplacement;
    text.remove_prefix(length != 0 ? length : 1);
  }
  return out;
}

void print_harmless(std::FILE* file, std::string_view lines) {
  const std::string out = harmless(lines, Keep::kLines);
  const bool is_whole = std::fwrite(out.data(), 1, out.size(), file) == out.size();
  // It is lost, since an exception would end the program when a thread reports something.
  if (is_whole || file == stderr) return;
  throw std::system_error(errno, std::generic_category(), "cannot write");
}

}  // namespace rubric::text
