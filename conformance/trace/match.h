// Matches a message against a line, and describes how they differ.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "conformance/trace/concrete.h"
#include "conformance/trace/schema.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// A field that differs from the pattern. Path "message": it is another message; "am": other AM
/// addresses; "bytes": other bytes.
struct Difference {
  std::string path;
  std::string expected;
  std::string seen;
  friend bool operator==(const Difference&, const Difference&) = default;
};

struct Match {
  std::vector<Difference> differences;  ///< In the order of the pattern.

  explicit operator bool() const { return differences.empty(); }
  /// Returns how far it is from matching, to find the nearest miss: another message is further away
  /// than any number of fields.
  std::size_t distance() const;
  /// Returns "seq_num: expected 7, seen 8; am: ...".
  std::string text() const;
};

/// Compares `seen` with the message of a line, its AM addresses and exact bytes. Ignores time, node
/// and link. Binds unbound variables only if everything matches; `!$q` and `$q+1..$q+2` never match
/// while q is unbound.
Match match(const Line& line, const Concrete& seen, Bindings& bindings);
/// The same, and binds nothing.
Match compare(const Line& line, const Concrete& seen, const Bindings& bindings);
/// Returns whether a message that the pattern names can be one of this name: compare() takes far
/// longer.
bool may_match(const Message& pattern, std::string_view seen);
/// Compares the message alone.
Match match(const Message& pattern, const Concrete& seen, Bindings& bindings);
/// Opens a message for faults of a link, which check only the fields that they name.
Message opened(const Message& message);

/// Returns the value with variables replaced. Throws TraceError at `*`, at a range and at an
/// unbound variable.
Value substituted(const Value& value, const Bindings& bindings, Place place);

/// Returns the number that the value means in this domain, a real as its 32 bits; with `!` another
/// one.
std::int64_t number_in(const Domain& domain, const Value& value, Place place);
/// Returns the bytes of hex or text; with `!` other bytes.
std::string bytes_in(const Value& value, Place place);

/// Returns the field by its whole path, even if it is positional; `position` counts those. Throws
/// TraceError if a path leads nowhere or to several fields, and if there are too many positional
/// ones.
FieldValue with_path(const FieldValue& field, const Shape& shape, std::size_t& position);
/// Returns all fields of a message.
std::vector<FieldValue> with_paths(const Message& message, const Shape& shape);

}  // namespace rubric::trace
