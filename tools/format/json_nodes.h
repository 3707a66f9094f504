// Prints the nodes of a decoded frame as JSON.
#pragma once

#include <cassert>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"
#include "tools/format/put.h"

namespace rubric::format {

// Ready-made pieces of JSON for every field and type of a protocol, so that printing a frame is
// mostly copying short runs of fixed length.

/// Text in one cache line, copied whole: writers need kPieceRoom characters after it.
struct alignas(64) Piece {
  char text[63] = {};
  std::uint8_t size = 0;

  /// Keeps `value` if it fits; returns whether it does.
  bool set(std::string_view value);
};
inline constexpr std::size_t kPieceRoom = 64;

RUBRIC_INLINE char* put(char* at, const Piece& piece) {
  std::memcpy(at, &piece, sizeof(piece));
  return at + piece.size;
}

/// Everything about a field that printing needs.
struct FieldPlan {
  Piece key;        ///< `,"seq_num":`
  Piece nameless;   ///< For enums: `,"type_name":null`
  Piece bits_open;  ///< For masks: `,"transducers_bits":[`
  const reflect::Field* field = nullptr;
  std::string long_key;  ///< The same where it does not fit in `key`.
  std::string name_key;  ///< `,"type_name":`
  std::string bits_key;  ///< `,"transducers_bits":`
  std::string hex_key;   ///< `,"text_hex":`
  std::string unit_key;  ///< `,"temp_degC":`
  /// For enums with close values: the member and its name for each value from first_value on,
  /// `,"type":35,"type_name":"updates"`; size 0 for a value without a name.
  std::vector<Piece> members;
  std::int64_t first_value = 0;
  std::vector<Piece> bits;  ///< For masks: `,"light"` for each bit.
  bool plain = false;       ///< A number with nothing beside it.
  bool enumerated = false;  ///< `members` is all there is to know of its names.
};

/// The plans of a protocol.
class JsonPlan {
 public:
  /// With `units` each field that has a unit is followed by its converted value.
  JsonPlan(const reflect::Protocol& protocol, bool units);

  /// Returns the plan of a field of the protocol's types; no other has one.
  const FieldPlan& field(const reflect::Field* field) const {
    if (slots_.empty()) return plans_[far_.at(field)];
    const auto slot = (reinterpret_cast<std::uintptr_t>(field) - first_address_) / kStep;
    assert(slot < slots_.size() && plans_[slots_[slot]].field == field);
    return plans_[slots_[slot]];
  }
  bool units() const { return units_; }
  /// Returns the most characters that one number or an opening and closing bracket take, slack
  /// included.
  std::size_t max_member_chars() const { return max_member_chars_; }

 private:
  static constexpr std::uintptr_t kStep = alignof(reflect::Field);

  void add(const reflect::Field& field);
  void index_addresses();

  bool units_;
  std::vector<FieldPlan> plans_;
  std::vector<std::uint16_t> slots_;  ///< By distance from the first field in memory.
  std::unordered_map<const reflect::Field*, std::uint16_t> far_;  ///< Where that is too long.
  std::uintptr_t first_address_ = 0;
  std::size_t max_member_chars_ = 0;
};

/// Writes an integer of the field.
inline char* put_integer(char* at, const reflect::Field& field, std::int64_t value) {
  return field.is_wide() ? put_uint(at, static_cast<std::uint64_t>(value)) : put_int(at, value);
}

/// Returns whether the field's bytes are shown as characters.
bool is_text(const reflect::Field* field);

/// Writes nodes by a protocol's plan, unchecked, into room that its caller made.
class JsonNodes {
 public:
  JsonNodes(const reflect::Protocol& protocol, bool units) : plan_(protocol, units) {}

  /// Returns an upper bound for everything that can be printed of this frame: all nodes, and three
  /// times its bytes in hex.
  std::size_t room(const reflect::Decoded& decoded) const {
    return decoded.node_count() * plan_.max_member_chars() +
           decoded.bytes.size() * (kMaxElementChars + 6) + kPieceRoom;
  }

  /// Writes the value of a node alone: an object, an array, a number, or hex in quotes.
  char* value(char* at, const reflect::Decoded& decoded, std::size_t node) const;

 private:
  static constexpr std::size_t kMaxElementChars = 2 * 34;

  char* object(char* at, const reflect::Decoded& decoded, std::size_t node) const;
  char* members(char* at, const reflect::Decoded& decoded, std::size_t from, std::size_t end) const;
  char* number(char* at, const FieldPlan& plan, std::int64_t value) const;
  char* number_beside(char* at, const FieldPlan& plan, std::int64_t value) const;
  char* array(char* at, const FieldPlan& plan, const reflect::Decoded& decoded,
              const reflect::Node& node) const;
  char* structs(char* at, const reflect::Decoded& decoded, std::size_t node) const;

  JsonPlan plan_;
};

/// Returns the value of a raw number in its field's unit, rounded to the raw number's precision.
double converted(const reflect::Field& field, std::int64_t raw);
/// Writes the same of a whole number with all its digits, as scale and offset are decimals; beyond
/// kMaxFloatChars characters the nearest double.
char* put_converted(char* at, const reflect::Field& field, std::int64_t raw);

}  // namespace rubric::format
