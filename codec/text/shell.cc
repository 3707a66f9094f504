#include "codec/text/shell.h"

#include <fmt/format.h>

#include "codec/text/text.h"

namespace rubric::text {

std::string shell_word(std::string_view text) {
  const bool plain = !text.empty() && text.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-./=:,+@%") == text.npos;
  if (plain) return std::string(text);
  // What a terminal would obey stands escaped, in the quotes that most shells have for that.
  if (harmless(text) != text) {
    std::string out = "$'";
    for (const char c : text) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == '\'' || c == '\\') {
        (out += '\\') += c;
      } else if (byte >= 0x20 && byte < 0x7f) {
        out += c;
      } else {
        out += fmt::format("\\x{:02x}", byte);
      }
    }
    return out + "'";
  }
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace rubric::text
