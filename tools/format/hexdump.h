// Prints the bytes of a frame, and the field of each.
#pragma once

#include "tools/format/record.h"

namespace rubric::format {

/// Appends rows of sixteen bytes. With colour a byte has its field's; without, there is a row of
/// letters below each, and a key to them at the end. '~' marks stale bytes, '!' the first byte of a
/// fault.
void append_hexdump(const Record& record, bool color, Buffer& out);

}  // namespace rubric::format
