// JSON text as a tree of values.
#pragma once

#include <stdexcept>
#include <string_view>

#include "codec/reflect/value.h"

namespace rubric::encode {

/// Text that is not JSON. what() has the expected syntax; the column counts from 1.
class JsonError : public std::runtime_error {
 public:
  JsonError(const std::string& problem, std::size_t column)
      : std::runtime_error(problem), column_(column) {}
  std::size_t column() const { return column_; }

 private:
  std::size_t column_;
};

/// Parses one JSON text. Numbers keep their spelling if an int64 cannot hold them, and an object
/// may contain a key only once. Throws JsonError.
reflect::Value parse_json(std::string_view text);

}  // namespace rubric::encode
