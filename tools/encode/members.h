// Members of a line around a message: checks them and turns them into a packet's. Parses the JSON
// that they come in.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "codec/containers/packet.h"
#include "codec/reflect/value.h"

namespace rubric::encode {

/// Returns the member; null if it is missing or null.
const reflect::Value* given(const reflect::Value& object, std::string_view key);

/// Returns a string member; empty if it is missing or null. Throws RecordError.
std::string_view text_of(const reflect::Value& object, std::string_view key);

/// Returns an integer member from 0 to `max`; nothing if it is missing or null. `path` is the
/// object's, for errors. Throws RecordError.
std::optional<std::int64_t> integer_of(const reflect::Value& object, std::string_view path,
                                       std::string_view key, std::int64_t max);

/// Converts seconds as a decimal number to nanoseconds, exactly; kNoTime for null. Throws
/// RecordError.
std::int64_t time_of(const reflect::Value* value);

/// Return the framing, direction and fault of a name. Throw RecordError.
Framing framing_of(const reflect::Value& line);
Direction direction_of(const reflect::Value& line);
Fault fault_of(const reflect::Value& line);

/// Returns whether a fault is one of the framing, not of the content.
bool is_framing_fault(Fault fault);

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
