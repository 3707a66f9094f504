// Text in fields of bytes: where its content ends, what of it is sound, and how it is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"

namespace rubric::reflect {

/// Returns whether the field's bytes are characters; a terminator alone makes none of them.
inline bool holds_characters(const Field& field) {
  return field.text && field.text->encoding != Encoding::kNone;
}

/// Returns the name of the encoding of characters.
const char* encoding_name(const Text& text);

/// Returns where the terminator begins; the number of bytes if there is none.
std::size_t terminator_at(const Text& text, Bytes bytes);

/// Returns the bytes before the terminator, without padding. A field without text has no more than
/// content.
Bytes text_content(const Field& field, Bytes all);

/// Returns how many bytes of the content are sound in the field's encoding, from its begin on.
std::size_t sound_text(const Field& field, Bytes content);

/// Returns the content as UTF-8; each byte that is not sound becomes U+FFFD.
std::string shown_text(const Field& field, Bytes all);

/// Returns whether append_text makes these bytes of what shown_text makes of them.
bool says_all(const Field& field, Bytes all);

/// Appends the text, its terminator and, up to `room` bytes, padding. Returns what is wrong with
/// it, else an empty text.
std::string append_text(const Field& field, std::string_view text, std::optional<std::size_t> room,
                        std::vector<std::uint8_t>& out);

}  // namespace rubric::reflect
