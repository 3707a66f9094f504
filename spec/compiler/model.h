// The model of a wire spec: the reader builds it, the checker completes it, and the emitters print
// it. Everything is decided here or in check.cc; emitters decide nothing.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/schema.h"

namespace rubricc {

/// A place in a spec file; line and column count from 1, 0 is unknown.
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;
};

struct Type;
struct Enum;
struct Field;
struct Spec;

/// Places of the values of keys, for diagnostics.
using KeyPlaces = std::map<std::string, SourcePlace, std::less<>>;

/// Least and greatest value that an expression or field can have, both included.
struct Interval {
  std::int64_t min = 0;
  std::int64_t max = 0;
};

enum class ExprOp {
  kInt,
  kField,
  kEnumValue,
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
  // Only at run time:
  kBitAnd,
  kBitOr,
  kBitXor,
  kShiftLeft,
  kShiftRight,
  kSelect,  // a ? b : c
};
struct Expr {
  ExprOp op = ExprOp::kInt;
  SourcePlace place;
  std::int64_t value = 0;         // kInt; kEnumValue once resolved.
  std::vector<std::string> path;  // kField: {"src", "devid"}; kEnumValue: {"pid", "local"}.
  bool to_i = false;              // `.to_i`: an enum's number.
  bool is_bool = false;           // kInt: true or false.
  std::vector<std::unique_ptr<Expr>> operands;
  // Resolved by the checker:
  const Field* field = nullptr;     // kField: the last field of the path.
  std::vector<const Field*> steps;  // kField: every field of the path.
  std::int64_t offset_bytes = -1;   // kField: from the start of the enclosing structure,
  int from = -1;                    // or, if it is at no constant position, of this field of it.
  int param = -1;                   // kField: number of the parameter that it is instead.
  Interval range;
};
using ExprPtr = std::unique_ptr<Expr>;

using ValueKind = rubric::reflect::Kind;  // Without kBits, which are kUint with a bit_width.
using RepeatKind = rubric::reflect::Repeat;
using ExtentKind = rubric::reflect::Extent;
using Encoding = rubric::reflect::Encoding;

struct Valid {
  SourcePlace place;
  // Any of these may be absent. `contents` and eq become one_of with one value.
  std::optional<std::int64_t> min;
  std::optional<std::int64_t> max;
  std::vector<std::int64_t> one_of;
  bool in_enum = false;  // The checker fills one_of from the enum.
  // As written; the checker resolves them to the numbers above.
  ExprPtr min_expr;
  ExprPtr max_expr;
  std::vector<ExprPtr> one_of_exprs;
};

struct SwitchCase {
  SourcePlace place;
  ExprPtr key_expr;                    // Null for `_`.
  std::optional<std::int64_t> number;  // The key, unless that had a mistake.
  std::int64_t key = 0;                // The same, for emitters.
  std::string type_name;
  std::vector<ExprPtr> arguments;
  const Type* type = nullptr;  // Resolved.
};
struct Switch {
  SourcePlace place;
  ExprPtr key;
  std::vector<SwitchCase> cases;        // Without `_`; ascending by key after the check.
  std::optional<SwitchCase> otherwise;  // `_`.
};

struct Unit {
  std::string symbol;
  double scale = 1;
  double offset = 0;
};

/// Characters, or a terminator of bytes.
struct Text {
  Encoding encoding = Encoding::kNone;
  int terminator = -1;
  int padding = -1;
  bool may_lack_its_end = false;
  std::string charset;  // kOther.
  int unit = 1;         // Bytes of the terminator.
};

struct Field {
  std::string id;
  std::string name;  // `-name`, else id.
  SourcePlace place;
  KeyPlaces places;
  bool refused_keys = false;  // Then what is missing may be among them.
  std::string doc;
  std::string doc_ref;
  std::string requirement;  // `-requirement`, else the type's.
  ValueKind kind = ValueKind::kBytes;
  int width_bytes = 0;  // For a number or mask.
  bool little_endian = false;
  RepeatKind repeat = RepeatKind::kOnce;
  ExtentKind extent = ExtentKind::kOwn;
  std::string type_name;  // As written: a user type, possibly "spec::type".
  std::vector<ExprPtr> arguments;
  const Type* type = nullptr;  // Resolved: a structure or a mask.
  std::unique_ptr<Switch> choice;
  std::string enum_name;
  const Enum* enumeration = nullptr;
  ExprPtr size;       // Extent kSize.
  ExprPtr count;      // Repeat kCount.
  ExprPtr until;      // Repeat kUntil.
  ExprPtr condition;  // `if`.
  std::optional<Valid> valid;
  ExprPtr expect_expr;  // `-expect`
  std::optional<std::int64_t> expect;
  std::optional<Unit> unit;
  std::optional<Text> text;
  int bit_width = 0;  // A number of so many bits; 0 for whole bytes.
  int bit_shift = 0;  // Number of the lowest one within width_bytes bytes; laid out by the checker.
  // Instances only.
  bool is_instance = false;
  std::int64_t position = -1;
  bool is_peek = false;  // A number that expressions read; never shown by itself.
  int overlays = -1;     // Interpretation: index of the seq field that it overlays.
  // Resolved by the checker.
  std::int64_t fixed_offset = -1;  // -1 where what comes before varies in size.
  std::uint32_t min_size = 0;      // Bytes, all repetitions; 0 if conditional.
  std::uint32_t max_size = 0;      // Bytes; UINT32_MAX if unbounded.
  Interval range;                  // Numbers: what valid leaves, else what the width allows.

  /// Returns how many of its bytes the field before it has, too: 1 for bits that begin within one.
  std::uint32_t shared_bytes() const {
    if (bit_width == 0) return 0;
    return (little_endian ? bit_shift : 8 * width_bytes - bit_shift - bit_width) != 0 ? 1 : 0;
  }
};

struct MaskBit {
  std::string name;
  bool unnamed = false;  // `-unnamed`
};

/// An instance that lies nowhere. It is not shown; where an expression reads it, what it is
/// computed from is read.
struct Computed {
  std::string id;
  std::string text;  // `value`; empty where the instance has none, or is there under a condition.
  SourcePlace place;
  std::string enum_name;
};

/// A value that a use of a type gives it: `type: part(length)`.
struct Param {
  std::string id;
  SourcePlace place;
  Interval range;
  bool is_bool = false;
  std::string enum_name;
  const Enum* enumeration = nullptr;
};

struct Type {
  std::string id;
  std::string name;  // `-name`, else id.
  const Spec* spec = nullptr;
  SourcePlace place;
  KeyPlaces places;
  bool refused_keys = false;  // Then what is missing may be among them.
  std::string doc;
  std::string doc_ref;
  std::string requirement;
  std::vector<std::unique_ptr<Field>> fields;     // seq
  std::vector<std::unique_ptr<Field>> instances;  // peeks and interpretations, in order
  std::vector<Param> params;
  std::vector<Computed> computed;
  bool is_mask = false;                       // `-mask`: then only bits, from the highest bit down.
  std::vector<MaskBit> bits;                  // From the highest down; as many as `-mask` says.
  std::optional<std::int64_t> declared_size;  // `-size`: the greatest size.
  std::vector<std::int64_t> am_types;         // `-am-type`
  std::string carrier;                        // `-carrier`
  std::string framing;                        // `-framing`
  bool has_crc = false;                       // `-crc`
  // Resolved by the checker.
  std::uint32_t min_size = 0;
  std::uint32_t max_size = 0;  // UINT32_MAX if unbounded.
  bool constant_size() const { return min_size == max_size; }
};

struct EnumEntry {
  std::int64_t value = 0;
  std::string name;
  std::string doc;
  SourcePlace place;
};
struct Enum {
  std::string id;
  const Spec* spec = nullptr;
  SourcePlace place;
  std::vector<EnumEntry> entries;  // Ascending by value after the check.
};

/// One .ksy file. The root structure, if the file has a top-level seq, is the first type; its id is
/// the spec's id.
struct Spec {
  std::string id;
  std::string title;
  std::string doc;
  std::string doc_ref;
  std::string file;  // As given on the command line: "spec/wire/rubicon.ksy".
  bool little_endian = false;
  bool lowest_bit_first = false;  // `bit-endian: le`
  std::string encoding;           // Of its text where a field has none.
  KeyPlaces places;
  bool named = false;  // On the command line; else only imported, not emitted.
  std::vector<std::string> import_names;
  std::vector<SourcePlace> import_places;
  std::vector<const Spec*> imports;
  std::vector<std::unique_ptr<Type>> types;   // In file order, the root first.
  std::vector<const Type*> dependency_order;  // The same, what a type contains before it.
  std::vector<std::unique_ptr<Enum>> enums;
};

struct Requirement {
  std::string id;
  std::string level;
  std::string clause;
  std::string sentence;
  std::string source;
  std::uint8_t roles = 0;            // Bits: 1 mote, 2 sink, 4 base station; 0 where it has none.
  bool forbids = false;              // It says what must not happen.
  std::string deployed;              // The difference of release 1.0; else empty.
  std::vector<std::string> shows;    // What a break looks like: words that are all seen.
  std::vector<std::string> differs;  // The wrong parts of a message that came.
  bool content = false;              // No missing message breaks it.
  SourcePlace place;
};

struct AcceptedDifference {
  std::string requirement;
  std::string sentence;  // The accepted behaviour.
};
struct Profile {
  std::string name;  // The file's: "paper".
  std::string file;
  std::string doc;
  std::vector<std::int64_t> values;  // In the order of profile_fields().
  std::vector<AcceptedDifference> accepted;
};

/// A rule named in a golden trace.
struct CaseUse {
  std::string case_name;
  std::string file;
  std::string requirement;
  bool negative = false;  // On a line of what must not happen.
};

/// All input of one run of the compiler. Specs in dependency order, imports first.
struct Model {
  std::vector<std::unique_ptr<Spec>> specs;
  std::vector<Requirement> requirements;
  std::vector<Profile> profiles;
  std::vector<CaseUse> case_uses;
};

struct ProfileField {
  std::string_view name;
  std::int64_t min;  // For a constant.
  std::int64_t max;
  bool is_switch;
};

/// Returns the fields in the order of the struct.
std::span<const ProfileField> profile_fields();

}  // namespace rubricc
