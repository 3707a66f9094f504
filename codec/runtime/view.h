// The parts of generated messages: numbers by byte order, lenses on arrays, arrays of values, and
// the small functions that every parse and write uses. Freestanding C++14.
#pragma once

#include <assert.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "codec/runtime/bytes.h"
#include "codec/runtime/fault.h"
#include "codec/runtime/result.h"

#define RUBRIC_UNLIKELY(x) __builtin_expect(!!(x), 0)
// Marks functions that report a failure: the hot path does not carry their code.
#define RUBRIC_COLD __attribute__((cold, noinline))
#define RUBRIC_MUST_USE __attribute__((warn_unused_result))

namespace rubric {

constexpr Error no_error() { return Error{Fault::kNone, 0, ReqId::kNone}; }
constexpr bool is_error(const Error& error) { return error.fault != Fault::kNone; }
constexpr Error error_at(Fault fault, size_t offset_bytes, ReqId requirement) {
  return Error{fault, static_cast<uint32_t>(offset_bytes), requirement};
}
/// Returns the error of a requirement's field that misses bytes; the place is where the bytes end.
constexpr Error truncated(Bytes bytes, ReqId requirement) {
  return error_at(Fault::kTruncated, bytes.size(), requirement);
}
/// Returns the error of a nested structure, seen from the structure around it.
constexpr Error moved(const Error& error, size_t by_bytes) {
  return error_at(error.fault, error.offset_bytes + by_bytes, error.requirement);
}
/// Returns the bytes that a structure with a greatest size may take; later bytes are not its.
constexpr Bytes at_most(Bytes bytes, size_t size_bytes) {
  return bytes.size() > size_bytes ? bytes.first(size_bytes) : bytes;
}
/// Returns the error of a payload or array of `have` bytes or elements where `want` are announced.
constexpr Error wrong_length(size_t have, size_t want, size_t offset_bytes, ReqId requirement) {
  return error_at(have < want ? Fault::kTruncated : Fault::kTrailing, offset_bytes, requirement);
}

/// Numbers on the wire: how many bytes, and how to read and write them at any alignment.
/// `fast_load` is for loops: compilers turn it into vector code more readily.
struct U8 {
  using Value = uint8_t;
  static constexpr size_t kSizeBytes = 1;
  static constexpr Value load(const uint8_t* p) { return load_u8(p); }
  static Value fast_load(const uint8_t* p) { return *p; }
  static void store(uint8_t* p, Value v) { store_u8(p, v); }
};

#define RUBRIC_WIRE_NUMBER(NAME, VALUE, BITS, ORDER, SWAPPED)                  \
  struct NAME {                                                                \
    using Value = VALUE;                                                       \
    static constexpr size_t kSizeBytes = BITS / 8;                             \
    static constexpr Value load(const uint8_t* p) {                            \
      return static_cast<Value>(load_##ORDER##BITS(p));                        \
    }                                                                          \
    static Value fast_load(const uint8_t* p) {                                 \
      uint##BITS##_t raw;                                                      \
      memcpy(&raw, p, sizeof(raw));                                            \
      return static_cast<Value>((SWAPPED) ? __builtin_bswap##BITS(raw) : raw); \
    }                                                                          \
    static void store(uint8_t* p, Value v) {                                   \
      store_##ORDER##BITS(p, static_cast<uint##BITS##_t>(v));                  \
    }                                                                          \
  };
RUBRIC_WIRE_NUMBER(U16Be, uint16_t, 16, be, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
RUBRIC_WIRE_NUMBER(U16Le, uint16_t, 16, le, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)
RUBRIC_WIRE_NUMBER(U32Be, uint32_t, 32, be, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
RUBRIC_WIRE_NUMBER(U32Le, uint32_t, 32, le, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)
RUBRIC_WIRE_NUMBER(S16Be, int16_t, 16, be, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
RUBRIC_WIRE_NUMBER(S16Le, int16_t, 16, le, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)
RUBRIC_WIRE_NUMBER(S32Be, int32_t, 32, be, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
RUBRIC_WIRE_NUMBER(S32Le, int32_t, 32, le, __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)
#undef RUBRIC_WIRE_NUMBER

/// Carries another wire number under another type: T is an enum, a mask or int8_t.
template <class T, class Number>
struct As {
  using Value = T;
  static constexpr size_t kSizeBytes = Number::kSizeBytes;
  static constexpr Value load(const uint8_t* p) { return static_cast<T>(Number::load(p)); }
  static Value fast_load(const uint8_t* p) { return static_cast<T>(Number::fast_load(p)); }
  static void store(uint8_t* p, Value v) {
    Number::store(p, static_cast<typename Number::Value>(v));
  }
};
using S8 = As<int8_t, U8>;

/// IEEE 754 binary32 in the byte order of `Number`.
template <class Number>
struct F32 {
  using Value = float;
  static constexpr size_t kSizeBytes = 4;
  static Value load(const uint8_t* p) { return float_of_bits(Number::load(p)); }
  static Value fast_load(const uint8_t* p) { return float_of_bits(Number::fast_load(p)); }
  static void store(uint8_t* p, Value v) { Number::store(p, bits_of_float(v)); }
};
using F32Be = F32<U32Be>;
using F32Le = F32<U32Le>;

/// Where a structure has a field that always begins at the same byte. Converts to that offset.
template <size_t kOffset>
struct PlaceAt {
  static constexpr size_t kAt = kOffset;
  constexpr operator size_t() const { return kOffset; }
};
/// The same for a number, which it reads and writes whatever the rest of the structure holds.
template <size_t kOffset, class Wire>
struct NumberAt : PlaceAt<kOffset> {
  using Number = Wire;
  using Value = typename Wire::Value;
  static constexpr size_t kEnd = kOffset + Wire::kSizeBytes;
  static Value load(const uint8_t* structure) { return Wire::load(structure + kOffset); }
  static void store(uint8_t* structure, Value value) { Wire::store(structure + kOffset, value); }
};
/// The same for a number that must lie in a range.
template <size_t kOffset, class Wire, int64_t kLeast, int64_t kMost>
struct RangedAt : NumberAt<kOffset, Wire> {
  static constexpr int64_t kMin = kLeast;
  static constexpr int64_t kMax = kMost;
  static constexpr bool allows(int64_t value) { return value >= kLeast && value <= kMost; }
};
/// The same for an array of numbers.
template <size_t kOffset, class Wire>
struct ArrayAt : PlaceAt<kOffset> {
  using Value = typename Wire::Value;
  static constexpr size_t kUnitBytes = Wire::kSizeBytes;
  static Value load(const uint8_t* structure, size_t i) {
    return Wire::load(structure + kOffset + i * kUnitBytes);
  }
  static void store(uint8_t* structure, size_t i, Value value) {
    Wire::store(structure + kOffset + i * kUnitBytes, value);
  }
};
/// Field `Inner` of the structure that is field `Outer`.
template <class Outer, class Inner>
using Within = NumberAt<Outer::kAt + Inner::kAt, typename Inner::Number>;

/// An array of values with room for kCapacity; the first `count` are meant.
template <class T, size_t kCapacity>
struct Array {
  T items[kCapacity] = {};
  uint16_t count = 0;

  static constexpr size_t capacity() { return kCapacity; }
  constexpr size_t size() const { return count; }
  constexpr const T& operator[](size_t i) const { return items[i]; }
  constexpr T& operator[](size_t i) { return items[i]; }
  constexpr const T* begin() const { return items; }
  constexpr const T* end() const { return items + count; }
  /// Appends; returns false, and does nothing, if there is no room.
  constexpr bool push(const T& item) {
    if (count >= kCapacity) return false;
    items[count++] = item;
    return true;
  }
};

namespace detail {

/// The key to the private constructors of views and builders: generated code makes one only over
/// bytes that are checked or that it laid out itself.
struct Access {
  template <class View>
  static constexpr View view(Bytes bytes) {
    return View(bytes);
  }
  template <class Builder>
  static constexpr Builder builder(MutableBytes out) {
    return Builder(out);
  }
};

/// Returns whether values are the same: floats are if their bits are, so that NaN compares too.
constexpr bool same(uint8_t a, uint8_t b) { return a == b; }
inline bool same(float a, float b) { return bits_of_float(a) == bits_of_float(b); }
inline bool same(Bytes a, Bytes b) { return equal(a, b); }
template <class T>
constexpr bool same(const T& a, const T& b) {
  return a == b;
}
template <class T, size_t kCount>
bool same(const T (&a)[kCount], const T (&b)[kCount]) {
  for (size_t i = 0; i < kCount; ++i) {
    if (!same(a[i], b[i])) return false;
  }
  return true;
}
template <class T, size_t kCapacity>
bool same(const Array<T, kCapacity>& a, const Array<T, kCapacity>& b) {
  if (a.count != b.count) return false;
  for (size_t i = 0; i < a.count; ++i) {
    if (!same(a.items[i], b.items[i])) return false;
  }
  return true;
}

inline void store_bytes(uint8_t* p, Bytes bytes) {
  if (!bytes.empty()) memmove(p, bytes.data(), bytes.size());
}
template <class Number>
void store_numbers(uint8_t* p, const typename Number::Value* from, size_t count) {
  for (size_t i = 0; i < count; ++i) Number::store(p + i * Number::kSizeBytes, from[i]);
}

}  // namespace detail

/// A lens on a borrowed array of numbers in bytes; whole elements only.
template <class Number>
class NumberArrayView {
 public:
  using Value = typename Number::Value;
  constexpr NumberArrayView() = default;

  /// Returns the number of elements.
  constexpr size_t size() const { return bytes_.size() / Number::kSizeBytes; }
  constexpr bool empty() const { return bytes_.empty(); }
  /// Returns an element; i < size().
  Value operator[](size_t i) const {
    assert(i < size());
    return Number::load(bytes_.data() + i * Number::kSizeBytes);
  }
  constexpr Bytes bytes() const { return bytes_; }
  /// Returns whether the bytes are the same.
  friend bool operator==(NumberArrayView a, NumberArrayView b) { return equal(a.bytes_, b.bytes_); }
  friend bool operator!=(NumberArrayView a, NumberArrayView b) { return !(a == b); }

  /// Copies the first `n` elements, or all if there are fewer; returns how many.
  size_t copy_to(Value* out, size_t n) const {
    if (n > size()) n = size();
    const uint8_t* p = bytes_.data();
    if (sizeof(Value) == 1) {  // The loop would be a copy, but g++ 12 warns of its remainder.
      if (n > 0) memcpy(static_cast<void*>(out), p, n);
      return n;
    }
    for (size_t i = 0; i < n; ++i) out[i] = Number::fast_load(p + i * Number::kSizeBytes);
    return n;
  }

  class Iterator {
   public:
    explicit Iterator(const uint8_t* at) : at_(at) {}
    Value operator*() const { return Number::load(at_); }
    Iterator& operator++() { return at_ += Number::kSizeBytes, *this; }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const uint8_t* at_;
  };
  Iterator begin() const { return Iterator(bytes_.data()); }
  Iterator end() const { return Iterator(bytes_.end()); }

 private:
  friend struct detail::Access;
  constexpr explicit NumberArrayView(Bytes bytes) : bytes_(bytes) {}

  Bytes bytes_;
};

/// A lens on an array of structures of constant size.
template <class View>
class StructArrayView {
 public:
  using Value = typename View::Value;
  constexpr StructArrayView() = default;

  /// Returns the number of elements.
  constexpr size_t size() const { return bytes_.size() / View::kMaxSizeBytes; }
  constexpr bool empty() const { return bytes_.empty(); }
  /// Returns an element; i < size().
  View operator[](size_t i) const {
    assert(i < size());
    return detail::Access::view<View>(bytes_.sub(i * View::kMaxSizeBytes, View::kMaxSizeBytes));
  }
  constexpr Bytes bytes() const { return bytes_; }
  /// Returns whether the bytes are the same.
  friend bool operator==(StructArrayView a, StructArrayView b) { return equal(a.bytes_, b.bytes_); }
  friend bool operator!=(StructArrayView a, StructArrayView b) { return !(a == b); }

  /// Copies the first `n` elements, or all if there are fewer; returns how many.
  size_t copy_to(Value* out, size_t n) const {
    if (n > size()) n = size();
    for (size_t i = 0; i < n; ++i) out[i] = (*this)[i].to_value();
    return n;
  }

  class Iterator {
   public:
    explicit Iterator(const uint8_t* at) : at_(at) {}
    View operator*() const { return detail::Access::view<View>(Bytes(at_, View::kMaxSizeBytes)); }
    Iterator& operator++() { return at_ += View::kMaxSizeBytes, *this; }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const uint8_t* at_;
  };
  Iterator begin() const { return Iterator(bytes_.data()); }
  Iterator end() const { return Iterator(bytes_.end()); }

 private:
  friend struct detail::Access;
  constexpr explicit StructArrayView(Bytes bytes) : bytes_(bytes) {}

  Bytes bytes_;
};

}  // namespace rubric
