// Whether a message is what a line asks for, and if not, how it differs.
#pragma once

#include <string>
#include <vector>

#include "conformance/trace/concrete.h"
#include "conformance/trace/trace.h"

namespace rubric::trace {

/// A field that is not as the pattern has it. Path "message": it is another message; "am": other
/// AM addresses; "bytes": other bytes.
struct Difference {
  std::string path;
  std::string expected;
  std::string seen;
  friend bool operator==(const Difference&, const Difference&) = default;
};

struct Match {
  std::vector<Difference> differences;  ///< In the order of the pattern.

  explicit operator bool() const { return differences.empty(); }
  /// How far from matching, to find the nearest miss: another message is further away than any
  /// number of fields.
  std::size_t distance() const;
  /// "seq_num: expected 7, seen 8; am: ...".
  std::string text() const;
};

/// Holds `seen` against the message of a line, its AM addresses and exact bytes. Time, node and
/// link are not looked at. Only where all matches are variables bound that were not yet; `!$q` and
/// `$q+1..$q+2` with nothing bound to q never match.
Match match(const Line& line, const Concrete& seen, Bindings& bindings);
/// The message alone.
Match match(const Message& pattern, const Concrete& seen, Bindings& bindings);
/// Faults of a link look at the fields that they name only; everything else is free.
Message opened(const Message& message);

}  // namespace rubric::trace
