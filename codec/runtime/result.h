// A value or an error: the result of every parse and write. Freestanding C++14, no exceptions.
#pragma once

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "codec/runtime/fault.h"
#include "codec/runtime/rule.h"

namespace rubric {

/// A fault, its place, and its rule. Cheap to return: no text, no allocation; the text is made
/// where it is shown.
struct Error {
  Fault fault;
  uint32_t offset_bytes;  ///< Offset in the input of the first byte that breaks the rule.
  ReqId requirement;      ///< The rule that it breaks.
};
constexpr bool operator==(const Error& a, const Error& b) {
  return a.fault == b.fault && a.offset_bytes == b.offset_bytes && a.requirement == b.requirement;
}
constexpr bool operator!=(const Error& a, const Error& b) { return !(a == b); }

/// Converts to a failed Result of any type.
struct Failure {
  Error error;
};
constexpr Failure fail(Fault fault, size_t offset_bytes, ReqId requirement) {
  return Failure{Error{fault, static_cast<uint32_t>(offset_bytes), requirement}};
}

/// A value, or the error that prevented it. T is default constructible.
template <class T>
class Result {
 public:
  constexpr Result(const T& value) : value_(value), error_{Fault::kNone, 0, ReqId::kNone} {}
  constexpr Result(Failure failure) : value_(), error_(failure.error) {}

  constexpr bool has_value() const { return error_.fault == Fault::kNone; }
  constexpr explicit operator bool() const { return has_value(); }
  constexpr const T& value() const { return assert(has_value()), value_; }
  constexpr const T& operator*() const { return value(); }
  constexpr const T* operator->() const { return &value(); }
  constexpr const Error& error() const { return error_; }

 private:
  T value_;
  Error error_;
};

}  // namespace rubric
