// What tools that keep a log write before each line, and editors before a file.
#pragma once

#include <cstddef>

#include "codec/runtime/bytes.h"

namespace rubric {

/// Returns the bytes of the time stamp that a line begins with, blanks and an arrow after it
/// included; 0 without one. Stamps are a text in brackets with a digit, as `[12.345]`; a number
/// with a point, as `1700000000.123`; and a time of day, as `12:34:56.789`, after a date or not:
/// those of `ts`, minicom and the Arduino IDE are. Hex text never begins so.
std::size_t stamp_size(Bytes line);

/// Returns the bytes of the mark with which editors begin a file of UTF-8 text: 3 or 0.
std::size_t mark_size(Bytes text);

}  // namespace rubric
