#include "codec/reflect/text_field.h"

#include <algorithm>

namespace rubric::reflect {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";

/// Returns the length of the character that the bytes begin with; 0 if they begin with none
/// (RFC 3629, section 4).
std::size_t character_bytes(Encoding encoding, Bytes text) {
  const std::uint8_t lead = text[0];
  if (lead < 0x80) return 1;
  if (encoding == Encoding::kAscii || lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (text.size() < length) return 0;
  const std::uint8_t low = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const std::uint8_t high = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (text[1] < low || text[1] > high) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if ((text[i] & 0xC0) != 0x80) return 0;
  }
  return length;
}

}  // namespace

Bytes text_content(const Field& field, Bytes all) {
  if (!field.text) return all;
  const Text& text = *field.text;
  std::size_t size = all.size();
  while (text.padding >= 0 && size != 0 && all[size - 1] == text.padding) --size;
  if (text.terminator < 0) return all.first(size);
  const std::uint8_t* const end = all.data() + size;
  const std::uint8_t* const found = std::find(all.data(), end, text.terminator);
  return all.first(static_cast<std::size_t>(found - all.data()));
}

std::size_t sound_text(const Field& field, Bytes content) {
  const Encoding encoding = field.text ? field.text->encoding : Encoding::kNone;
  if (encoding == Encoding::kNone) return content.size();
  std::size_t at = 0;
  while (at < content.size()) {
    const std::size_t length = character_bytes(encoding, content.from(at));
    if (length == 0) return at;
    at += length;
  }
  return at;
}

std::string shown_text(const Field& field, Bytes all) {
  Bytes rest = text_content(field, all);
  std::string out;
  while (true) {
    const std::size_t sound = sound_text(field, rest);
    out.append(rest.data(), rest.data() + sound);
    if (sound == rest.size()) return out;
    out += kReplacement;
    rest = rest.from(sound + 1);
  }
}

bool says_all(const Field& field, Bytes all) {
  const Bytes content = text_content(field, all);
  if (sound_text(field, content) != content.size()) return false;
  const bool sized = field.extent != Extent::kTerminated;
  std::vector<std::uint8_t> again;
  const std::string shown(content.data(), content.data() + content.size());
  append_text(field, shown, sized ? std::optional(all.size()) : std::nullopt, again);
  return equal(all, Bytes(again.data(), again.size()));
}

std::string append_text(const Field& field, std::string_view text, std::optional<std::size_t> room,
                        std::vector<std::uint8_t>& out) {
  const Text& how = *field.text;
  const std::size_t begin = out.size();
  out.insert(out.end(), text.begin(), text.end());
  const Bytes content(out.data() + begin, text.size());
  if (sound_text(field, content) != content.size()) {
    return how.encoding == Encoding::kAscii ? "expected ASCII" : "expected UTF-8";
  }
  if (text_content(field, content).size() != content.size()) {
    return "expected text without its own terminator or padding";
  }
  const bool ends = how.terminator >= 0 && (!room || *room > text.size());
  if (ends) out.push_back(static_cast<std::uint8_t>(how.terminator));
  if (room && *room > out.size() - begin && (how.padding >= 0 || how.terminator >= 0)) {
    out.resize(begin + *room, static_cast<std::uint8_t>(std::max<int>(how.padding, 0)));
  }
  return {};
}

}  // namespace rubric::reflect
