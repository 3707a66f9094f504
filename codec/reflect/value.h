// A tree of values like those of JSON, from which the encoder writes bytes. Readers of JSON (or
// similar formats) build one; nothing here knows a text format.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rubric::reflect {

/// Copyable and plain; members of an object keep their order.
struct Value {
  enum class Kind : std::uint8_t { kNull, kBool, kInteger, kReal, kString, kArray, kObject };

  Kind kind = Kind::kNull;
  std::int64_t integer = 0;            ///< kInteger; kBool: 0 or 1.
  std::string text = {};               ///< kString; kReal: the number as it was written.
  std::vector<Value> items = {};       ///< kArray, kObject.
  std::vector<std::string> keys = {};  ///< kObject: keys[i] names items[i].

  static Value of_integer(std::int64_t number) {
    return {.kind = Kind::kInteger, .integer = number};
  }
  static Value of_string(std::string_view string) {
    return {.kind = Kind::kString, .text = std::string(string)};
  }
  static Value of_real(std::string_view literal) {
    return {.kind = Kind::kReal, .text = std::string(literal)};
  }
  static Value of_array(std::vector<Value> elements) {
    return {.kind = Kind::kArray, .items = std::move(elements)};
  }
  static Value of_object() { return {.kind = Kind::kObject}; }

  bool is(Kind k) const { return kind == k; }

  /// Returns the member of an object, or null if there is none.
  const Value* find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == key) return &items[i];
    }
    return nullptr;
  }

  /// Adds a member to an object.
  Value& set(std::string_view key, Value value) {
    keys.emplace_back(key);
    items.push_back(std::move(value));
    return *this;
  }
};

}  // namespace rubric::reflect
