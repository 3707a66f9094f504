// A value in a frame, for filters and columns.
#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>

#include "codec/reflect/schema.h"
#include "codec/runtime/bytes.h"

namespace rubric::format {

/// Borrowed from the record, or valid during the visit.
struct Value {
  enum class Kind : std::uint8_t {
    kAbsent,
    kInteger,
    kReal,
    kText,
    kBytes,
    kTime,
    kBits,
    kUnit,
    kNode
  };
  Kind kind = Kind::kAbsent;
  std::int64_t integer = 0;               ///< kInteger, kBits, kUnit: raw; kTime: nanoseconds.
  double real = 0;                        ///< kReal; kUnit: converted.
  std::string_view text;                  ///< kText; beside kInteger its name, where it has one.
  Bytes bytes;                            ///< kBytes.
  const reflect::Field* field = nullptr;  ///< For a field's value: its enum and bit names.
  std::size_t node = 0;                   ///< kNode: a structure or an array of structures.

  static Value of_integer(std::int64_t value, std::string_view name = {}) {
    return {.kind = Kind::kInteger, .integer = value, .text = name};
  }
  static Value of_real(double value) { return {.kind = Kind::kReal, .real = value}; }
  static Value of_text(std::string_view value) { return {.kind = Kind::kText, .text = value}; }
  static Value of_bytes(Bytes value) { return {.kind = Kind::kBytes, .bytes = value}; }
};

/// Takes values until it returns false.
class Visitor {
 public:
  template <class F>
  requires(!std::is_same_v<std::remove_cv_t<F>, Visitor>)
      Visitor(F& call)  // NOLINT: a borrowed view of a callable.
      : object_(&call), call_([](void* object, const Value& value) -> bool {
          return (*static_cast<F*>(object))(value);
        }) {}
  bool operator()(const Value& value) const { return call_(object_, value); }

 private:
  void* object_;
  bool (*call_)(void*, const Value&);
};

}  // namespace rubric::format
