// Decodes bytes by the reflection tables into a flat list of nodes that every view of a frame
// (text, JSON, filters, hex dumps) reads. It knows the tables' form and no protocol.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"
#include "codec/runtime/result.h"

namespace rubric::reflect {

/// The kind of a node of a decoded frame.
enum class NodeKind : std::uint8_t {
  kNumber,       ///< kUint, kSint, kFloat or kMask of the field; `value` holds it.
  kNumberArray,  ///< `count` numbers in a row, to be read from the bytes.
  kBytes,        ///< Opaque bytes.
  kStruct,       ///< Its fields follow as children.
  kStructArray,  ///< `count` kStruct children.
};

/// A field of a decoded frame. Nodes are in preorder; children of node i are i + 1 up to `end`.
struct Node {
  const Field* field;    ///< Null for the outermost structure.
  const Type* type;      ///< For structures; null elsewhere.
  std::int64_t value;    ///< Numbers; a float as its 32 bits.
  std::uint32_t offset;  ///< In bytes, from the start of the frame.
  std::uint32_t size;    ///< In bytes, without stale bytes.
  std::uint32_t end;     ///< Index of the first node after this one's children.
  std::uint32_t count;   ///< Elements of an array.
  NodeKind kind;
};

/// A remarkable fact that does not make a frame malformed.
enum class NoteKind : std::uint8_t {
  kUnknownMessage,   ///< No message has this key; the bytes stay opaque.
  kDoesNotFit,       ///< The bytes do not fit the message that their key names; they stay opaque.
  kUnexpectedValue,  ///< A field's value is not the expected one.
  kNotDecoded,       ///< The frame is of a kind that carries no message known here.
  kNotText,          ///< A byte, `value`, does not belong to the text's encoding.
  kRadioOnly,        ///< A serial packet holds a message that travels on the radio only.
};
struct Note {
  NoteKind kind;
  std::uint32_t offset;  ///< In bytes, from the start of the frame.
  const Field* field;    ///< The note's field.
  const Type* type;      ///< kDoesNotFit, kRadioOnly: the message that was tried.
  std::int64_t value;    ///< The key, or the value.
};

struct Range {
  std::uint32_t offset;
  std::uint32_t size;
};

/// A decoded frame. Reuse one object for many frames: it allocates only while it grows.
class Decoded {
 public:
  static constexpr std::size_t kMaxNotes = 16;
  static constexpr std::size_t kMaxPath = 8;
  static constexpr std::size_t kMaxStale = 8;

  Bytes bytes;                                 ///< The frame; borrowed.
  Error error{Fault::kNone, 0, ReqId::kNone};  ///< For the first rule that the bytes break.
  /// With an error: its field, or null, and a number: the field's value, for kTruncated the bytes
  /// that it needs, for kTrailing the bytes too many.
  const Field* error_field = nullptr;
  std::int64_t error_value = 0;

  const Node* nodes() const { return nodes_.get(); }
  std::size_t node_count() const { return node_count_; }
  const Node& operator[](std::size_t i) const { return nodes_[i]; }

  const Note* notes() const { return notes_; }
  std::size_t note_count() const { return note_count_; }

  /// Returns the chosen messages from the outermost in.
  const Type* const* path() const { return path_; }
  std::size_t path_count() const { return path_count_; }
  /// Returns the innermost message, or null.
  const Type* message() const { return path_count_ ? path_[path_count_ - 1] : nullptr; }

  /// Returns the bytes after the meant content, in ascending order of offset.
  const Range* stale() const { return stale_; }
  std::size_t stale_count() const { return stale_count_; }

  /// Forgets everything but the bytes.
  void clear(Bytes frame);
  /// Adds a note of the framing; beyond kMaxNotes it is dropped.
  void add_note(const Note& note);

  /// Returns the index of the child of `parent` with this name, or 0 (which is never a child).
  std::size_t child(std::size_t parent, std::string_view name) const;

 private:
  friend class Decoder;
  std::unique_ptr<Node[]> nodes_;
  std::size_t capacity_ = 0;
  std::size_t node_count_ = 0;
  std::size_t note_count_ = 0;
  std::size_t path_count_ = 0;
  std::size_t stale_count_ = 0;
  Note notes_[kMaxNotes];
  const Type* path_[kMaxPath];
  Range stale_[kMaxStale];
};

/// Says whether bytes after the outermost structure are stale or a fault (Fault::kTrailing).
enum class Tail : std::uint8_t { kStale, kFault };

/// Decodes `bytes` as `type`. `is_message`: the type itself is the first name of the path.
/// Everything decoded before a fault stays in `out`. Bytes must not exceed 2^31. `more`: chooses
/// for keys that the outermost structure's own choice has no type for; its choice is noted as
/// kRadioOnly, and stays opaque if it does not fit.
void decode(const Type& type, Bytes bytes, Tail tail, bool is_message, Decoded& out,
            const Switch* more = nullptr);

/// Returns the value of an expression over the structure that begins at `base`, whose loads lie
/// within `bytes` (the spec compiler proves it, loads beyond the end give 0). `params`: what the
/// parameters of its type are, if it has some; without them they are 0.
std::int64_t evaluate(const Expr& expr, Bytes structure, const std::int64_t* params = nullptr);

/// Returns the same where loads may count from fields: `start_of` returns where the field of an
/// index begins in the structure, kNowhere if it is not there.
inline constexpr std::size_t kNowhere = INT32_MAX / 2;
template <class StartOf>
std::int64_t evaluate_floating(const Expr& expr, Bytes structure, const StartOf& start_of,
                               const std::int64_t* params = nullptr) {
  ExprStep steps[UINT8_MAX] = {};
  std::copy_n(expr.steps, expr.count, steps);
  for (int i = 0; i < expr.count; ++i) {
    const std::uint16_t from = std::exchange(steps[i].from, std::uint16_t{0});
    if (from != 0) steps[i].value += static_cast<std::int32_t>(start_of(from - 1));
  }
  return evaluate({steps, expr.count}, structure, params);
}

/// Returns what the switch chooses for the key, its type null for opaque.
struct Chosen {
  const Type* type;
  const Argument* arguments;
};
Chosen choose_with(const Switch& choice, std::int64_t key);

/// Returns the type that the switch chooses for the key; null for opaque.
const Type* choose(const Switch& choice, std::int64_t key);

/// Looks up by name as shown or by id; returns null if there is none.
const Type* find_type(const Protocol& protocol, std::string_view name);
/// Returns the carrier's structure; null if the protocol does not travel on it.
const Type* find_carrier(const Protocol& protocol, std::string_view carrier);
/// Returns the entry's name, or null.
const char* enum_name(const EnumTable& table, std::int64_t value);

/// Returns element `i` of a number array, or the number itself for i = 0; a float as its 32 bits.
std::int64_t load_number(const Field& field, const std::uint8_t* at);

}  // namespace rubric::reflect
