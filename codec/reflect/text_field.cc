#include "codec/reflect/text_field.h"

#include <iconv.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <mutex>
#include <new>
#include <utility>

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

/// Appends what the bytes are in the other encoding, up to the first that are nothing in their own.
/// Returns how many bytes that took. Each conversion of iconv(3) is opened once and kept for all
/// threads: a thread's own would end the process where memory for its end is missing.
std::size_t convert(const char* from, const char* to, std::string_view bytes, std::string& out) {
  static std::mutex one_at_a_time;
  // Never destroyed, as what it holds is used to the end.
  static auto& all = *new std::map<std::pair<std::string, std::string>, iconv_t>;
  const std::lock_guard lock(one_at_a_time);
  const auto none = reinterpret_cast<iconv_t>(-1);
  auto found = all.find({from, to});
  if (found == all.end()) {
    const iconv_t open = iconv_open(to, from);
    if (open == none && errno == ENOMEM) throw std::bad_alloc();
    found = all.try_emplace({from, to}, open).first;
  }
  const iconv_t conversion = found->second;
  if (conversion == none) return 0;
  iconv(conversion, nullptr, nullptr, nullptr, nullptr);
  char* in = const_cast<char*>(bytes.data());  // iconv() does not write there.
  std::size_t left = bytes.size();
  while (left != 0) {
    char part[256];
    char* end = part;
    std::size_t room = sizeof(part);
    const std::size_t before = left;
    const bool good = iconv(conversion, &in, &left, &end, &room) != static_cast<std::size_t>(-1);
    out.append(part, end);
    if (good || left == before) break;
  }
  return bytes.size() - left;
}

constexpr const char* kUtf8Name = "UTF-8";

/// Returns the bytes as UTF-8, up to the first that are no character; `sound` is their number.
std::string sound_part(const Field& field, Bytes content, std::size_t& sound) {
  std::string out;
  const std::string_view all(reinterpret_cast<const char*>(content.data()), content.size());
  if (field.text && field.text->encoding == Encoding::kOther) {
    sound = convert(field.text->charset, kUtf8Name, all, out);
  } else {
    sound = sound_text(field, content);
    out = all.substr(0, sound);
  }
  return out;
}

}  // namespace

const char* encoding_name(const Text& text) {
  if (text.encoding == Encoding::kOther) return text.charset;
  return text.encoding == Encoding::kAscii ? "ASCII" : kUtf8Name;
}

std::size_t terminator_at(const Text& text, Bytes bytes) {
  for (std::size_t at = 0; at + text.unit <= bytes.size(); at += text.unit) {
    const std::uint8_t* const p = bytes.data() + at;
    if (std::count(p, p + text.unit, text.terminator) == text.unit) return at;
  }
  return bytes.size();
}

Bytes text_content(const Field& field, Bytes all) {
  if (!field.text) return all;
  const Text& text = *field.text;
  std::size_t size = all.size();
  while (text.padding >= 0 && size != 0 && all[size - 1] == text.padding) --size;
  if (text.terminator < 0) return all.first(size);
  return all.first(terminator_at(text, all.first(size)));
}

std::size_t sound_text(const Field& field, Bytes content) {
  const Encoding encoding = field.text ? field.text->encoding : Encoding::kNone;
  if (encoding == Encoding::kNone) return content.size();
  std::size_t at = 0;
  if (encoding == Encoding::kOther) {
    sound_part(field, content, at);
    return at;
  }
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
    std::size_t sound = 0;
    out += sound_part(field, rest, sound);
    if (sound == rest.size()) return out;
    out += kReplacement;
    rest = rest.from(std::min<std::size_t>(sound + field.text->unit, rest.size()));
  }
}

bool says_all(const Field& field, Bytes all) {
  const Bytes content = text_content(field, all);
  std::size_t sound = 0;
  const std::string shown = sound_part(field, content, sound);
  if (sound != content.size()) return false;
  const bool sized = field.extent != Extent::kTerminated;
  std::vector<std::uint8_t> again;
  append_text(field, shown, sized ? std::optional(all.size()) : std::nullopt, again);
  return equal(all, Bytes(again.data(), again.size()));
}

std::string append_text(const Field& field, std::string_view text, std::optional<std::size_t> room,
                        std::vector<std::uint8_t>& out) {
  const Text& how = *field.text;
  const std::size_t begin = out.size();
  std::string bytes(text);
  if (how.encoding == Encoding::kOther) {
    bytes.clear();
    if (convert(kUtf8Name, how.charset, text, bytes) != text.size()) {
      return std::string("expected text in ") + how.charset;
    }
  }
  out.insert(out.end(), bytes.begin(), bytes.end());
  const Bytes content(out.data() + begin, bytes.size());
  if (sound_text(field, content) != content.size()) {
    return std::string("expected ") + encoding_name(how);
  }
  if (text_content(field, content).size() != content.size()) {
    return "expected text without its own terminator or padding";
  }
  const bool ends = how.terminator >= 0 && (!room || *room >= bytes.size() + how.unit);
  if (ends) out.insert(out.end(), how.unit, static_cast<std::uint8_t>(how.terminator));
  if (room && *room > out.size() - begin && (how.padding >= 0 || how.terminator >= 0)) {
    out.resize(begin + *room, static_cast<std::uint8_t>(std::max<int>(how.padding, 0)));
  }
  return {};
}

}  // namespace rubric::reflect
