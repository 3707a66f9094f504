// Values in a form for people and spreadsheets.
#pragma once

#include "tools/format/json_nodes.h"
#include "tools/format/path.h"

namespace rubric::format {

/// Appends one value: numbers with their shortest text, masks as "light|temp", bytes as hex,
/// structures as JSON, text with control characters made harmless.
void append_plain_value(const Value& value, const Record& record, const JsonNodes& nodes,
                        Buffer& out);
/// Appends all values of a path (of the first field that it leads to), separated by spaces.
void append_plain_values(const Path& path, const Record& record, const JsonNodes& nodes,
                         Buffer& out);

/// Appends the names of the bits that are set: "light|temp", "bit13" for one without a name, "0"
/// for none.
void append_bits(const reflect::MaskTable& mask, std::int64_t value, Buffer& out);

/// Returns text::harmless() of the text in quotes, with those within it escaped.
std::string quoted(std::string_view text);

}  // namespace rubric::format
