// A frame in the making: its bytes with their meaning, so that the effect of a change is known.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubric::generate {

inline constexpr std::uint32_t kNone = UINT32_MAX;

/// A structure: where it begins, and where its surroundings make it end.
struct Scope {
  std::uint32_t parent;  ///< Index of the scope around it; kNone for the outermost.
  std::uint32_t base;    ///< In bytes from the start of the frame.
  std::uint32_t end;     ///< Set by a size, an element's width or the frame; kNone: its parent's.
  const reflect::Type* type;
};

enum class PartKind : std::uint8_t {
  kNumber,
  kBytes,  ///< Opaque bytes, perhaps with an interpretation.
  kArray,  ///< Elements; those that are structures follow as scopes.
  kRoom,   ///< The place of a structure whose size is given elsewhere, or that takes what is left.
};

/// A field of the frame, in the order in which a decoder reaches it.
struct Part {
  PartKind kind;
  const reflect::Field* field;
  std::uint32_t scope;          ///< Index of the structure that it belongs to.
  std::uint32_t at;             ///< In bytes from the start of the frame.
  std::uint32_t size;           ///< In bytes.
  std::uint32_t element_bytes;  ///< Arrays: of an element; else 1.
  std::uint32_t measure;        ///< Part with the number that alone says its size; kNone if none.
  std::uint32_t last_inside;    ///< Index after the last part within it.
  bool open;                    ///< It takes what is left, so that a shorter one is as good.
  bool hard;                    ///< False within an interpretation: what does not fit stays opaque.
};

/// Opaque bytes that are meant as a message.
struct Body {
  const reflect::Type* type = nullptr;   ///< The message; null where there is none.
  const reflect::Type* owner = nullptr;  ///< The structure whose field the bytes are.
  std::uint16_t field = 0;               ///< Index in the owner's fields.
  std::uint32_t base = 0;                ///< Start of the owner.
  std::uint32_t part = 0;                ///< Index of the bytes; the message's follow.
  std::uint32_t last_inside = 0;         ///< Index after the last of them.
};

struct Draft {
  std::vector<std::uint8_t> bytes;
  std::vector<Part> parts;
  std::vector<Scope> scopes;               ///< The first is the carrier's.
  std::vector<const reflect::Type*> path;  ///< The messages from the outermost in.
  std::vector<std::uint32_t> ends;         ///< Where a list of elements that vary in size may end.
  Body body;
  bool radio = false;
  bool bare = false;  ///< The message alone: bytes after it are stale.

  /// Returns where a decoder of this frame stops the structure.
  std::uint32_t limit(std::uint32_t scope) const;
  /// Returns the first part that lacks bytes if all ends at `limit`, among [from, to); kNone if
  /// none does. `passed`: parts whose measure was made to agree. `hard`: only among those that a
  /// decoder requires.
  std::uint32_t first_cut(std::uint32_t limit, std::uint32_t from, std::uint32_t to,
                          const std::vector<std::uint32_t>& passed, bool hard = true) const;
};

}  // namespace rubric::generate
