// Prints the nodes of a decoded frame as JSON.
#pragma once

#include "codec/reflect/decode.h"
#include "tools/format/json_plan.h"

namespace rubric::format {

/// Writes nodes by a protocol's plan, unchecked, into room that its caller made.
class JsonNodes {
 public:
  JsonNodes(const reflect::Protocol& protocol, bool units) : plan_(protocol, units) {}

  /// Returns an upper bound for everything that can be printed of this frame: all nodes, and three
  /// times its bytes in hex.
  std::size_t room(const reflect::Decoded& decoded) const {
    return decoded.node_count() * plan_.max_member_chars() +
           decoded.bytes.size() * (kMaxElementChars + 6) + kPieceRoom;
  }

  /// Writes the value of a node alone: an object, an array, a number, or hex in quotes.
  char* value(char* at, const reflect::Decoded& decoded, std::size_t node) const;

 private:
  static constexpr std::size_t kMaxElementChars = 2 * 34;

  char* object(char* at, const reflect::Decoded& decoded, std::size_t node) const;
  char* members(char* at, const reflect::Decoded& decoded, std::size_t from, std::size_t end) const;
  char* number(char* at, const FieldPlan& plan, std::int64_t value) const;
  char* number_beside(char* at, const FieldPlan& plan, std::int64_t value) const;
  char* array(char* at, const FieldPlan& plan, const reflect::Decoded& decoded,
              const reflect::Node& node) const;
  char* structs(char* at, const reflect::Decoded& decoded, std::size_t node) const;

  JsonPlan plan_;
};

/// Returns the value of a raw number in its field's unit, rounded to the raw number's precision.
double converted(const reflect::Field& field, std::int64_t raw);

}  // namespace rubric::format
