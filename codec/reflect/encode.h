// Encodes a tree of values into bytes by the reflection tables: the inverse of decode.h. Host code;
// firmware writes through the generated builders.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "codec/reflect/decode.h"
#include "codec/reflect/schema.h"
#include "codec/reflect/value.h"
#include "codec/runtime/bytes.h"

namespace rubric::reflect {

/// Values that cannot be encoded: where, why, and by which rule. The caller names the rule, as this
/// library does not hold the rules' texts.
class EncodeError : public std::runtime_error {
 public:
  EncodeError(std::string path, std::string problem, ReqId requirement,
              std::int64_t missing_bytes = 0)
      : std::runtime_error(path + ": " + problem),
        path_(std::move(path)),
        problem_(std::move(problem)),
        requirement_(requirement),
        missing_bytes_(missing_bytes) {}

  /// Returns the field: "payload.updates[3].value"; empty for the outermost structure.
  const std::string& path() const { return path_; }
  /// Returns what was expected and what was given.
  const std::string& problem() const { return problem_; }
  /// Returns the broken rule; ReqId::kNone if none is broken.
  ReqId requirement() const { return requirement_; }
  /// Returns how many bytes a given size counts that no field is; at most 0 for other problems.
  std::int64_t missing_bytes() const { return missing_bytes_; }

 private:
  std::string path_;
  std::string problem_;
  ReqId requirement_;
  std::int64_t missing_bytes_;
};

/// Appends `fields`, an object, as `type` to `out`.
///
/// Takes the output of decoding: numbers; enumerators as a number, as their name, or as their name
/// under "X_name"; masks as a number, or as an array of bit names (also under "X_bits"); floats
/// also as "NaN", "Infinity" and "-Infinity"; opaque bytes as hex; an interpretation in place of
/// the bytes that it overlays. A number that only gives the size of what follows may be missing and
/// is filled in; if given, it must agree. A missing field with a single possible or an expected
/// value takes that value.
///
/// `stale` are the bytes after the meant content, in order. They fill what a given size says beyond
/// the content; the rest goes to the end of the outermost part of open size, with Tail::kStale the
/// end of `type` itself. `more` chooses as in decode. Throws EncodeError; `out` is then
/// unspecified.
void encode(const Type& type, const Value& fields, Bytes stale, Tail tail,
            std::vector<std::uint8_t>& out, const Switch* more = nullptr);

/// Parses hex text, ignoring spaces. Returns false at anything else.
bool parse_hex(std::string_view text, std::vector<std::uint8_t>& out);

/// Finds the enumerator of that name; returns false if there is none.
bool enum_value(const EnumTable& table, std::string_view name, std::int64_t& value);

/// Returns the number of the bit of that name, or of "bit13"; -1 if there is none.
int mask_bit(const MaskTable& table, std::string_view name);

}  // namespace rubric::reflect
