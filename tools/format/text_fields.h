// Prints the fields of a frame on one line: name=value.
#pragma once

#include "tools/format/record.h"
#include "tools/format/style.h"

namespace rubric::format {

/// Bytes of an opaque field or frame that a line shows.
inline constexpr std::size_t kMaxHexBytes = 24;

struct FieldStyle {
  bool units = false;     ///< Values with a unit are shown converted.
  bool in_turns = false;  ///< Values in the colours of the hex dump.
};

/// Appends all fields of the outermost message. Structures of two numbers are pairs, "dest=11:2";
/// messages within the message follow after a bar.
void append_fields(const Record& record, FieldStyle style, Styled& styled);

/// Appends hex of the first `most` bytes, and their number if there are more.
void append_hex_short(Bytes bytes, std::size_t most, Buffer& out);

}  // namespace rubric::format
