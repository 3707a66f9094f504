// The form of the reflection tables: a protocol as constant data. The spec compiler emits the
// tables (codec/generated/*/tables.h); the decoder, the encoder and the tools only read them, so
// none of them knows a protocol. Plain C++14 data without constructors or allocation.
#pragma once

#include <stdint.h>

#include "codec/runtime/rule.h"

namespace rubric {
namespace reflect {

struct Type;

struct EnumEntry {
  uint32_t value;
  const char* name;
};
/// Entries in ascending order of value.
struct EnumTable {
  const char* name;
  const EnumEntry* entries;
  uint16_t count;
};

/// bit_names[i] names bit i (from the least significant); null if it has no name.
struct MaskTable {
  const char* name;
  const char* const* bit_names;
  uint8_t width_bits;
};

/// A step of an expression, in postfix order on a stack of int64. Loads read a number at a constant
/// offset from the start of the enclosing structure.
enum class Op : uint8_t {
  kConst,
  kLoadU8,
  kLoadBe16,
  kLoadLe16,
  kLoadBe32,
  kLoadLe32,
  kAdd,
  kSub,
  kMul,
  kDiv,
  kMod,
  kEq,
  kNe,
  kLt,
  kLe,
  kGt,
  kGe,
  kAnd,
  kOr,
  kNot,
  // Only in specs that are read at run time:
  kParam,
  kBitAnd,
  kBitOr,
  kBitXor,
  kShiftLeft,
  kShiftRight,
  kSelect,  ///< Of three values the second, if the first is not zero, else the third.
};
/// Returns whether a step puts a number of the frame on the stack.
constexpr bool is_load(Op op) { return op >= Op::kLoadU8 && op <= Op::kLoadLe32; }
struct ExprStep {
  Op op;
  int32_t value;  ///< The constant, the offset in bytes of a load, or the number of a parameter.
  /// 1 + the index of the field from whose start the load's offset counts; 0: the structure's
  /// start.
  uint16_t from = 0;  // Another one only in specs that are read at run time.
};
/// No steps: the expression is absent. At most kMaxExprDepth values on the stack.
struct Expr {
  const ExprStep* steps;
  uint8_t count;
  bool floats = false;  ///< A step counts from a field.
};
constexpr int kMaxExprDepth = 8;

/// The whole numbers of all fields, with a sign and without.
__extension__ using Whole = __int128;

/// A range with both ends included.
struct Span {
  Whole min;
  Whole max;

  constexpr bool has(Whole value) const { return min <= value && value <= max; }
};

/// The allowed values of an integer. Values compare as unsigned (as signed for Kind::kSint); those
/// of Field::is_wide() are kept as the same bits.
enum class ValidKind : uint8_t { kAny, kRange, kOneOf };
struct Valid {
  ValidKind kind;
  int64_t min;            ///< kRange.
  int64_t max;            ///< kRange.
  const int64_t* one_of;  ///< kOneOf.
  uint8_t one_of_count;

  /// Returns whether a value lies between two, both included, with a sign or without.
  static constexpr bool within(int64_t value, int64_t least, int64_t most) {
    return static_cast<uint64_t>(value) - static_cast<uint64_t>(least) <=
           static_cast<uint64_t>(most) - static_cast<uint64_t>(least);
  }
};

/// Physical value = raw * scale + offset, in `symbol`.
struct Unit {
  const char* symbol;
  double scale;
  double offset;
};

/// What a parameter of a type is for one use of it; a value beyond min to max is a fault.
struct Argument {
  Expr value;
  int64_t min;
  int64_t max;
};

struct SwitchCase {
  int64_t key;
  const Type* type;
  const Argument* arguments = nullptr;  ///< One for each parameter of the type.
};
/// Chooses the type of a field by a key. Cases in ascending order of key. Null `otherwise`: bytes
/// without a case stay opaque.
struct Switch {
  Expr key;
  const SwitchCase* cases;
  uint16_t count;
  const Type* otherwise;
  const Argument* otherwise_arguments = nullptr;
};

enum class Kind : uint8_t {
  kUint,    ///< width_bytes 1, 2 or 4; 8 only in specs that are read at run time.
  kSint,    ///< The same.
  kFloat,   ///< IEEE 754 binary32.
  kBits,    ///< bit_width bits of a number of width_bytes bytes, 1 to 4.
  kMask,    ///< width_bytes 1 or 2, with a MaskTable.
  kBytes,   ///< Opaque bytes.
  kStruct,  ///< `type`, or what `choice` chooses.
};
/// kUntil: until a condition on the element holds; only in specs that are read at run time.
enum class Repeat : uint8_t { kOnce, kCount, kToEnd, kUntil };
enum class Extent : uint8_t {
  kOwn,         ///< The size of its kind.
  kSize,        ///< `size` bytes.
  kToEnd,       ///< All bytes that the enclosing structure has left.
  kTerminated,  ///< Bytes up to its text's terminator, which is the last of them.
};

/// kOther: one that iconv(3) reads, by its name.
enum class Encoding : uint8_t { kNone, kAscii, kUtf8, kOther };
/// How the bytes of a field are to be read (codec/reflect/text_field.h). kNone: as bytes.
struct Text {
  Encoding encoding;
  int16_t terminator;  ///< A byte that ends the content; -1 if there is none.
  int16_t padding;     ///< A byte that fills the field after the content; -1 if none is stripped.
  bool may_lack_its_end;          ///< kTerminated: the bytes may end without a terminator.
  const char* charset = nullptr;  ///< kOther: the name of the encoding.
  uint8_t unit = 1;               ///< Bytes of the terminator, which lies at a multiple of them.
};

struct Field {
  const char* name;      ///< As shown: the spec's `-name` if there is one.
  const char* json_key;  ///< The same with quotes and colon: "\"seq_num\":".
  uint8_t json_key_size;
  Kind kind;
  uint8_t width_bytes;  ///< For a number or mask; 0 for bytes and structures.
  bool little_endian;
  Repeat repeat;
  Extent extent;
  /// Offset in bytes from the start of the structure, -1 if the fields before it vary in size.
  int32_t fixed_offset;
  /// Least and greatest value, in the form of Valid; structures and bytes have ValidKind::kAny.
  Valid valid;
  /// A value that is expected but not required (noted, not refused); -1 if none.
  int64_t expect;
  const EnumTable* enumeration;
  const MaskTable* mask;
  const Type* type;      ///< kStruct without a choice.
  const Switch* choice;  ///< kStruct with a choice.
  Expr size;             ///< Extent::kSize: bytes.
  Expr count;            ///< Repeat::kCount: elements.
  Expr condition;        ///< Present only if not zero.
  ReqId requirement;
  const Unit* unit;
  const char* doc;
  // Only in specs that are read at run time:
  const Text* text = nullptr;           ///< kBytes with characters or a terminator.
  uint8_t bit_width = 0;                ///< kBits.
  uint8_t bit_shift = 0;                ///< kBits: number of the lowest bit within the number.
  Expr until = {nullptr, 0};            ///< Repeat::kUntil: over the element, from its begin on.
  const Argument* arguments = nullptr;  ///< kStruct: one for each parameter of `type`.

  /// Returns whether its values have 64 bits and no sign. Where numbers are kept as int64 they have
  /// the same bits: those from 2^63 on are negative there.
  constexpr bool is_wide() const { return kind == Kind::kUint && width_bytes == 8; }
  /// Returns the number that is kept as these bits.
  constexpr Whole whole(int64_t bits) const {
    return is_wide() ? Whole{static_cast<uint64_t>(bits)} : Whole{bits};
  }
  /// Returns the least and the greatest number that its bits hold; for a float its 32 bits.
  constexpr Span held() const {
    const Whole all = Whole{1} << (kind == Kind::kBits ? bit_width : 8 * width_bytes);
    return kind == Kind::kSint ? Span{-all / 2, all / 2 - 1} : Span{0, all - 1};
  }
  /// Returns the same within a range that its rule states.
  constexpr Span limits() const {
    return valid.kind == ValidKind::kRange ? Span{whole(valid.min), whole(valid.max)} : held();
  }

  /// Returns how many of its bytes the field before it has too: 1 for bits that begin within one.
  constexpr uint8_t shared_bytes() const {
    return kind == Kind::kBits &&
           (little_endian ? bit_shift : 8 * width_bytes - bit_shift - bit_width) != 0;
  }
};

/// An interpretation of bytes that a sequence field leaves opaque: tried in order, the first whose
/// condition holds and whose type fits is shown in place of the field `overlays` (its index in
/// `fields`). Bytes that fit none stay opaque, with a note.
struct Interpretation {
  Field field;  ///< kStruct with Extent::kToEnd, fixed_offset >= 0.
  uint16_t overlays;
};

struct Type {
  const char* id;    ///< Name in the spec.
  const char* name;  ///< As shown: the spec's `-name` if there is one.
  const Field* fields;
  uint16_t field_count;
  const Interpretation* interpretations;
  uint16_t interpretation_count;
  uint32_t min_size;  ///< Bytes; the least that parses.
  uint32_t max_size;  ///< Bytes; UINT32_MAX where it is as large as its surroundings.
  int32_t am_type;    ///< -1 if none.
  ReqId requirement;
  const char* doc;
  const char* doc_ref;
  const char* const* params = nullptr;  ///< Names of its parameters, at most kMaxParams.
  uint8_t param_count = 0;
};
constexpr int kMaxParams = 8;

/// The structure that a carrier's frames begin with: "serial", "radio_i", "radio_t", "radio_ack".
struct Carrier {
  const char* name;
  const Type* type;
};

struct Protocol {
  const char* id;
  const char* title;
  const Type* const* types;  ///< In the order of the spec; carriers' structures included.
  uint16_t type_count;
  const EnumTable* const* enums;
  uint16_t enum_count;
  const MaskTable* const* masks;
  uint16_t mask_count;
  const Carrier* carriers;
  uint16_t carrier_count;
};

/// A number of a frame that must have this value, so that the frame leads to a message.
struct RouteChoice {
  uint16_t offset;  ///< From the start of the frame.
  uint8_t width_bytes;
  bool little_endian;
  uint32_t value;
};
/// A number that counts the bytes of the frame from `from` on.
struct RouteLength {
  uint16_t offset;
  uint8_t width_bytes;
  bool little_endian;
  uint16_t from;
};
/// How a frame reaches a message (codec/generated/*/messages.h), for the structure-aware fuzzer and
/// other builders of frames; the message's own contents are in its Type.
struct Route {
  const char* carrier;  ///< Carrier of the frames: "serial", "radio_i", ...; "bare": none.
  const Type* type;     ///< The message.
  uint16_t offset;      ///< Offset of its begin.
  uint32_t room;        ///< The most bytes that it can have there; UINT32_MAX if unbounded.
  const RouteChoice* choices;
  uint8_t choice_count;
  const RouteLength* lengths;
  uint8_t length_count;
};
struct RouteTable {
  const Route* routes;
  uint16_t count;
};

/// The roles that must follow a requirement.
enum Roles : uint8_t { kRoleMote = 1, kRoleSink = 2, kRoleBaseStation = 4 };

/// A requirement's texts; codec/reflect/requirements.h has them all.
struct Requirement {
  const char* id;
  const char* level;
  const char* clause;
  const char* sentence;
  const char* source;
  uint8_t roles;         ///< Bits of Roles; 0 where the rule names none (those of the wire).
  bool forbids;          ///< It says what must not happen: a case has to attempt it.
  const char* deployed;  ///< The difference of release 1.0; empty if there is none.

  constexpr ReqId number() const { return *id == '\0' ? ReqId::kNone : rule_number(id); }
};

}  // namespace reflect
}  // namespace rubric
